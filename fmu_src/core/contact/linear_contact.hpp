/// One Newton step of an implicit step with contact: the equations linearised at x, with as many touches as it takes,
///
///      A dx = residual + sum of (load n + friction),      load >= 0,  gap(x + dx) >= 0,  load gap = 0,      A = K + diagonal.
///
/// Active set: with the touches as they are, the normal motions are prescribed and the loads are what these equations lack; a touch that
/// pulls ends, a point that the motion takes behind a plane begins to touch. The loads come from the linear equations, so that their sum
/// is the momentum that the body lost, to rounding, whatever the stiffness.
///
/// Friction of a sliding point is its load, found in this very solution, times mu, against its slip. This makes the equations
/// unsymmetric; the factor is that of the symmetric part, and a few iterations on the loads do the rest (gmres.hpp).
#pragma once
#include "contact/contact_set.hpp"
#include "matrix/gmres.hpp"
#include "matrix/spring_hessian.hpp"

namespace softffd {

class LinearContact {
 public:
  explicit LinearContact(const Lattice& lattice);

  /// The state that the equations are linearised at, and the sizes that they are judged by.
  struct Problem {
    const Body& body;
    const Points& x0;         ///< positions at the beginning of the step [m]
    const Points& u;          ///< displacements from there [m]
    const Points& x;          ///< their sum
    const Points& residual;   ///< all forces but those of contact [N]
    const Scalars& diagonal;  ///< (points) [N/m]
    double h;                 ///< [s]
    double slack;             ///< gaps above -slack count as none [m]
    double force_scale;       ///< [N]
    double stiffness_scale;   ///< [N/m]
  };

  /// The next solution is to start from new matrices.
  void refresh() { stale_ = true; }
  /// Finds `change`, `reaction` and the touches with their loads. cautious: friction by its majorant and with the loads used, which
  /// converges slower but does not run in circles. Returns false if the equations have no finite solution.
  bool solve(const Problem& problem, ContactSet& contacts, bool cautious);

  Points change;         ///< dx [m]
  Points reaction;       ///< A dx - residual: what contact and pins do to the points [N]
  bool settled = false;  ///< the touches are those of the solution
  bool fresh = false;    ///< the matrix is that of this state

  Count factorizations() const { return factorizations_; }
  /// As LatticeMatrix counts them.
  double solutions() const { return solutions_; }

 private:
  void linearise(const Problem& problem, double softening);
  bool solve_with_touches(const Problem& problem, ContactSet& contacts, bool cautious);
  void solve_free_part(const Problem& problem, const ContactSet& contacts);
  void couple_loads(const Problem& problem, ContactSet& contacts);
  void respond(const Problem& problem, const ContactSet& contacts, const Scalars& loads, double accuracy);
  void forces_of(const Problem& problem, const Points& u, Points& f) const;

  SpringHessian hessian_;
  LatticeMatrix matrix_;
  Gmres gmres_;
  Points x_;  ///< that the matrix was made at
  Points prescribed_, friction_, response_, made_, moved_;
  Scalars lack_;
  bool stale_ = true;
  double softening_ = 1;  ///< of compressed springs, as SpringHessian has it
  Count factorizations_ = 0;
  double solutions_ = 0;
};

}  // namespace softffd
