/// The matrix of the equations of an implicit step, linearised at a state, and solutions with it: A = K + diagonal, where K contains the
/// second derivatives of springs, dashpots and volume stiffness. The part that makes K indefinite is reduced until A has a factor.
#pragma once
#include "matrix/stiffness_matrix.hpp"
#include "model/free_body.hpp"

namespace softffd {

/// The rigid part that belongs to a free pin. The pin's points move with it. It has six unknowns, or one if it is on a guide.
struct FreePart {
  const std::vector<int>* points = nullptr;
  Vec3 centre = Vec3::Zero();                         ///< of mass, of the part with its points [m]
  Vec3 guide = Vec3::Zero();                          ///< unit vector; zero: no guide
  double mass = 0;                                    ///< with the points [kg]
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  ///< in world axes [kg m2]
  Twist moved = {};                                   ///< motion since the step began, stored itself, so that rounding is small
  Wrench lack = {};  ///< residual of the part's own equation: loads less inertia, without the inertia of the points [N], [N m]

  int unknowns() const { return guide.isZero(0) ? 6 : 1; }
  /// Returns the motion, per unit of unknown i, of a point at the end of an arm from the centre.
  Vec3 motion(int i, const Vec3& arm) const {
    if (!guide.isZero(0)) return guide;
    return i < 3 ? Vec3(Vec3::Unit(i)) : Vec3(Vec3::Unit(i - 3).cross(arm));
  }
};

/// The state at which the equations are linearised, and the scales by which their solution is judged.
struct StepProblem {
  const Body& body;
  const Points& x0;         ///< positions at the beginning of the step [m]
  const Points& u;          ///< displacements from x0 [m]
  const Points& x;          ///< x0 + u [m]
  const Points& residual;   ///< of the balance of forces without contact [N]
  const Scalars& diagonal;  ///< (points) due to inertia and drag [N/m]
  double h;                 ///< step [s]
  double slack;             ///< a gap above -slack counts as no penetration [m]
  double force_scale;       ///< largest force besides contact [N]
  double stiffness_scale;   ///< largest stiffness [N/m]
  double loads_left;        ///< fraction of the error in the loads of sliding points that may be left for the next iteration [1]
  double load_slack;        ///< fraction of the largest force: smaller pulls do not end a touch, smaller loads need not be found [1]
  std::vector<FreePart> parts = {};
};

/// The result of one solution of the linearised equations.
struct StepSolution {
  Points change;         ///< dx [m]
  Points reaction;       ///< forces that contact and pins have to exert: A dx - residual [N]
  bool again = false;    ///< obstacles have turned since the linearisation: iterate again, with the same matrix
  bool settled = false;  ///< the touches are consistent with the solution
  bool fresh = false;    ///< the matrix was made at this state
};

class StepMatrix {
 public:
  explicit StepMatrix(const Lattice& lattice);

  /// Linearises at x for a step of h [s], with all terms that make A indefinite. diagonal: (points), due to inertia and drag [N/m].
  void linearise(const Points& x, const Scalars& diagonal, double h);
  /// Reduces the terms that make A indefinite. Returns false if none is left.
  bool soften();
  /// Assembles A and returns it. Its blocks may be changed before it is factored.
  LatticeMatrix& assemble(const Body& body);
  /// Factors A, with the parts of free pins. count: the factorization counts as work; one that restores an earlier factor does not.
  void factor(const StepProblem& problem, bool count = true);
  /// b <- A^-1 b. Points with prescribed motion do not move; points of free parts move with their parts.
  void solve(Points& b, double accuracy = ConjugateGradients::exact);
  void solve_together(std::span<Points* const> sides);
  int sides_at_once() const { return columns_.empty() ? matrix_.sides_at_once() : 1; }
  /// The same for a residual b, with the residuals `lack` of the parts' own equations.
  void solve_residual(const StepProblem& problem, Points& b);
  /// f = A u, with A as it was assembled.
  void forces_of(const StepProblem& problem, const Points& u, Points& f) const;

  Count factorizations() const { return factorizations_; }
  double solutions() const { return solutions_; }  ///< work of the solutions, as counted by LatticeMatrix

 private:
  /// One unknown of a part: the forces due to a unit of the unknown, and the motion of the other points by these forces.
  struct Column {
    int part, unknown;
    Points forces, moved;
  };
  void condense(const StepProblem& problem);
  double along(int i, const Points& forces) const;
  void solve_with_parts(Points& b, const std::vector<double>& lack, double accuracy);

  LatticeMatrix matrix_;
  std::vector<FreePart> parts_;
  Points at_;  ///< positions at which the parts were condensed [m]
  std::vector<Column> columns_;
  Eigen::MatrixXd condensed_;  ///< inverse of the Schur complement of the parts' unknowns
  std::vector<bool> pinned_;
  Points x_;                  ///< positions at which K is made [m]
  Linearisation linearised_;  ///< how K is made
  Scalars diagonal_;          ///< (points) due to inertia and drag [N/m]
  Count factorizations_ = 0;
  double solutions_ = 0;
};

}  // namespace softffd
