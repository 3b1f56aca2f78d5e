/// Projection of a vector onto several half-spaces, and Coulomb friction on several planes at once, for one point.
///
/// A control point's mass matrix is m I, so the contact problem of one point is min |v - v*|^2 subject to n_q . v >= b_q: a projection in
/// three dimensions. Its solution has at most three active planes; sets of one, two and three planes are tried, and a set whose
/// multipliers are not negative and whose point is feasible is the solution. Planes enter the trial only when they are violated.
#pragma once
#include <vector>

#include "model/plane.hpp"

namespace softffd {

/// One plane's demand on the velocity (or position) v of a point: normal . v >= bound.
struct Constraint {
  Vec3 normal = Vec3::UnitZ();           ///< unit vector
  double bound = 0;                      ///< [m/s] (or [m])
  double friction = 0;                   ///< Coulomb coefficient
  Vec3 surface = Vec3::Zero();           ///< velocity of the obstacle's material [m/s]
  double normal_impulse = 0;             ///< result: multiplier, >= 0, per unit mass [m/s]
  Vec3 friction_impulse = Vec3::Zero();  ///< result: tangential, |.| <= friction * normal_impulse [m/s]
};

/// Moves a position that is behind planes by rounding to the front of all planes, as far as rounding permits.
void push_out(const std::vector<HalfSpace>& planes, Vec3& x);

/// Workspace for one point's projections; nothing is allocated after construction.
class FeasibleSet {
 public:
  explicit FeasibleSet(int planes) { trial_.reserve(planes); }

  /// Moves v to the nearest feasible vector and writes the normal impulses. `slack`: violation that is allowed for rounding.
  /// Returns false if no vector is feasible.
  bool project(std::vector<Constraint>& constraints, double slack, Vec3& v);

  /// The same with friction: Gauss-Seidel sweeps over the normal impulse and the friction disk of each plane. The exact projection always
  /// comes last, so that feasibility does not depend on the convergence of friction.
  bool resolve(std::vector<Constraint>& constraints, double slack, Vec3& v);

 private:
  bool solve_trial(std::vector<Constraint>& constraints, double slack, const Vec3& target, Vec3& v);
  std::vector<int> trial_;
};

}  // namespace softffd
