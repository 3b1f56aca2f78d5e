/// The equations of an implicit step, linearised at a state: A = K + diagonal, K being the second derivatives of springs, dashpots and
/// volume stiffness; and solutions with A. Less and less of what makes K indefinite is taken until A has a factor.
#pragma once
#include "matrix/stiffness_matrix.hpp"

namespace softffd {

/// The state that the equations are linearised at, and the sizes that they are judged by.
struct StepProblem {
  const Body& body;
  const Points& x0;         ///< positions at the beginning of the step [m]
  const Points& u;          ///< displacements from there [m]
  const Points& x;          ///< their sum
  const Points& residual;   ///< all forces but those of contact [N]
  const Scalars& diagonal;  ///< (points) of the inertia and the damping [N/m]
  double h;                 ///< [s]
  double slack;             ///< gaps above -slack count as none [m]
  double force_scale;       ///< [N]
  double stiffness_scale;   ///< [N/m]
  double loads_left;        ///< of what the loads of sliding points lack, what may be left for the next iteration [1]
  double load_slack;        ///< of the largest force: pulls that are no reason to end a touch, loads that need not be found [1]
};

/// What one solution of them gives.
struct StepSolution {
  Points change;         ///< dx [m]
  Points reaction;       ///< what the equations lack without contact and pins: A dx - residual [N]
  bool settled = false;  ///< the touches are those of the solution
  bool fresh = false;    ///< the matrix is that of this state
};

class StepMatrix {
 public:
  explicit StepMatrix(const Lattice& lattice);

  /// K at problem.x, with all that makes it indefinite.
  void linearise(const StepProblem& problem);
  /// The same with less of it. Returns false if there is no less.
  bool soften();
  /// A, whose blocks may be changed before it is factored.
  LatticeMatrix& assemble(const StepProblem& problem);
  void factor();
  /// b <- A^-1 b.
  void solve(Points& b, double accuracy = ConjugateGradients::exact) { solutions_ += matrix_.solve(b, accuracy); }
  /// f = A u, A as it was assembled.
  void forces_of(const StepProblem& problem, const Points& u, Points& f) const;

  Count factorizations() const { return factorizations_; }
  double solutions() const { return solutions_; }  ///< as LatticeMatrix counts them

 private:
  LatticeMatrix matrix_;
  Points x_;                  ///< that K is made at
  Linearisation linearised_;  ///< and how
  Count factorizations_ = 0;
  double solutions_ = 0;
};

}  // namespace softffd
