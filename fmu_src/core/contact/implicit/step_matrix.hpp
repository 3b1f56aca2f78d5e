/// The equations of an implicit step, linearised at a state: A = K + diagonal, K being the second derivatives of springs, dashpots and
/// volume stiffness; and solutions with A. Less and less of what makes K indefinite is taken until A has a factor.
#pragma once
#include "matrix/stiffness_matrix.hpp"
#include "model/free_body.hpp"

namespace softffd {

/// The part of a free pin: its points move with it, by six unknowns, or one on a guide.
struct FreePart {
  const std::vector<int>* points = nullptr;
  Vec3 centre = Vec3::Zero();                         ///< of all that moves [m]
  Vec3 guide = Vec3::Zero();                          ///< zero: none
  double mass = 0;                                    ///< [kg]
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  ///< in the world [kg m2]
  Twist moved = {};                                   ///< since the step began: straight numbers, in which rounding is small
  Wrench lack = {};  ///< of its own equation: what its loads and its inertia leave, the points' inertia in their own rows [N], [N m]

  int unknowns() const { return guide.isZero(0) ? 6 : 1; }
  /// By which unknown i moves a point at the end of an arm from the centre.
  Vec3 motion(int i, const Vec3& arm) const {
    if (!guide.isZero(0)) return guide;
    return i < 3 ? Vec3(Vec3::Unit(i)) : Vec3(Vec3::Unit(i - 3).cross(arm));
  }
};

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
  std::vector<FreePart> parts = {};
};

/// What one solution of them gives.
struct StepSolution {
  Points change;         ///< dx [m]
  Points reaction;       ///< what the equations lack without contact and pins: A dx - residual [N]
  bool again = false;    ///< obstacles have turned since it was linearised, the matrix serves on
  bool settled = false;  ///< the touches are those of the solution
  bool fresh = false;    ///< the matrix is that of this state
};

class StepMatrix {
 public:
  explicit StepMatrix(const Lattice& lattice);

  /// A at x for a step of h [s], with all that makes it indefinite. diagonal: (points) of the inertia and the damping [N/m].
  void linearise(const Points& x, const Scalars& diagonal, double h);
  /// The same with less of it. Returns false if there is no less.
  bool soften();
  /// A, whose blocks may be changed before it is factored.
  LatticeMatrix& assemble(const Body& body);
  /// count: it is work; one that has been made before is none.
  void factor(const StepProblem& problem, bool count = true);
  /// b <- A^-1 b: what pins prescribe does not move, what free parts hold moves with them.
  void solve(Points& b, double accuracy = ConjugateGradients::exact);
  void solve_together(std::span<Points* const> sides);
  int sides_at_once() const { return columns_.empty() ? matrix_.sides_at_once() : 1; }
  /// The same of a residual, with what the parts' own equations lack.
  void solve_residual(const StepProblem& problem, Points& b);
  /// f = A u, A as it was assembled.
  void forces_of(const StepProblem& problem, const Points& u, Points& f) const;

  Count factorizations() const { return factorizations_; }
  double solutions() const { return solutions_; }  ///< as LatticeMatrix counts them

 private:
  /// A part's unknown: forces that it makes by a unit of it, and what these move.
  struct Column {
    int part, unknown;
    Points forces, moved;
  };
  void condense(const StepProblem& problem);
  double along(int i, const Points& forces) const;
  void solve_with_parts(Points& b, const std::vector<double>& lack, double accuracy);

  LatticeMatrix matrix_;
  std::vector<FreePart> parts_;
  Points at_;  ///< positions that they were condensed at [m]
  std::vector<Column> columns_;
  Eigen::MatrixXd condensed_;  ///< inverse of what is left for the parts' unknowns
  std::vector<bool> pinned_;
  Points x_;                  ///< that K is made at
  Linearisation linearised_;  ///< and how
  Scalars diagonal_;          ///< (points) of the inertia and the damping
  Count factorizations_ = 0;
  double solutions_ = 0;
};

}  // namespace softffd
