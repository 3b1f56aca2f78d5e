/// Object and free bodies that nothing else holds: what they have of angular momentum together changes by outside torques alone. Implicit
/// steps lose some, as every method does that damps what it cannot follow: a common turn of all velocities, by which no contact changes,
/// gives it back.
#pragma once
#include "body/equations.hpp"
#include "model/state.hpp"

namespace softffd {

class Isolated {
 public:
  /// Are there free bodies, and no other obstacles, pins, guides or dampers?
  static bool is(const Equations& equations);
  /// Before a step.
  void begin(const Equations& equations, const State& state);
  /// The outside's forces on points at x and on bodies, for `weight` [s].
  void add(double weight, const Points& force, const Points& x, const std::vector<FreeState>& free);
  /// After it. Returns the energy that the turn gives [J].
  double give_back(const Points& x, Points& v, std::vector<FreeState>& free) const;

 private:
  struct Whole {
    Vec3 centre, momentum;  ///< of mass [m]; angular, about it [kg m2/s]
    Eigen::Matrix3d inertia;
  };
  Whole whole(const Points& x, const Points* v, const std::vector<FreeState>& free) const;
  const Equations* equations_ = nullptr;
  Vec3 momentum_ = Vec3::Zero();  ///< that there should be
};

}  // namespace softffd
