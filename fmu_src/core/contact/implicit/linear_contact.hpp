/// One Newton step of an implicit step with contact: the equations linearised at x, with the touches that they require,
///
///      A dx = residual + sum of (load n + friction),      load >= 0,  gap(x + dx) >= 0,  load gap = 0,      A = K + diagonal.
///
/// An active set method finds the touches. For given touches the normal motions are prescribed, and the loads are the residual of the
/// linearised equations. A touch that pulls ends; a point that the motion takes behind a plane begins to touch. As the loads come from the
/// linear equations, their sum is the momentum that the body lost, to rounding, whatever the stiffness.
///
/// The friction of a sliding point is mu times its load in this very solution, against its slip. This makes the equations unsymmetric: the
/// symmetric part is factored, and a few iterations on the loads do the rest (gmres.hpp).
#pragma once
#include "contact/implicit/contact_set.hpp"
#include "contact/implicit/step_matrix.hpp"
#include "matrix/gmres.hpp"

namespace softffd {

class LinearContact : public StepSolution {
 public:
  explicit LinearContact(const Lattice& lattice);

  /// Makes the next solution start from new matrices.
  void refresh() { stale_ = true; }
  /// Lets the next solution use the present matrix if the touches are the same. slight: a change of friction's stiffness that does not
  /// matter [N/m].
  void keep(double slight) { kept_ = true, slight_ = slight; }
  /// Finds `change`, `reaction`, and the touches with their loads. cautious: friction by its majorant and with the loads used, which
  /// converges more slowly but does not run in circles. Returns false if the equations have no finite solution.
  bool solve(const StepProblem& problem, ContactSet& contacts, bool cautious);

  const StepMatrix& matrix() const { return matrix_; }

 private:
  bool solve_with_touches(const StepProblem& problem, ContactSet& contacts, bool cautious);
  void solve_free_part(const StepProblem& problem, const ContactSet& contacts);
  void couple_loads(const StepProblem& problem, ContactSet& contacts);
  void respond(const StepProblem& problem, const ContactSet& contacts, const Scalars& loads, double accuracy);

  StepMatrix matrix_;
  Gmres gmres_;
  Points prescribed_, friction_, response_, made_, moved_;
  Scalars lack_;
  bool stale_ = true, kept_ = false;
  double slight_ = 0;
};

}  // namespace softffd
