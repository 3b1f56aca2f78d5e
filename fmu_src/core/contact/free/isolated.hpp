/// Object and free bodies that nothing else holds: their total angular momentum changes by outside torques alone. Implicit steps lose
/// some of the angular momentum, like every method that damps what it cannot follow. A common rotation added to all velocities, by which
/// no contact changes, restores the angular momentum.
#pragma once
#include "body/equations.hpp"
#include "model/state.hpp"

namespace softffd {

class Isolated {
 public:
  /// True if there are free bodies, and no other obstacles or pins, no guides and no nodal viscous drag.
  static bool is(const Equations& equations);
  /// Begins a step: stores the angular momentum.
  void begin(const Equations& equations, const State& state);
  /// Adds the angular impulse of the outside forces on points at x and on free bodies during `weight` [s].
  void add(double weight, const Points& force, const Points& x, const std::vector<FreeState>& free);
  /// Restores the angular momentum after the step. Returns the energy that the added rotation gives [J].
  double give_back(const Points& x, Points& v, std::vector<FreeState>& free) const;

 private:
  struct Whole {
    Vec3 centre, momentum;  ///< centre of mass [m]; angular momentum about it [kg m2/s]
    Eigen::Matrix3d inertia;
  };
  Whole whole(const Points& x, const Points* v, const std::vector<FreeState>& free) const;
  const Equations* equations_ = nullptr;
  Vec3 momentum_ = Vec3::Zero();  ///< angular momentum that the whole should have [kg m2/s]
};

}  // namespace softffd
