/// Obstacle planes: rigid half-spaces in rigid motion.
#pragma once
#include "rotation.hpp"

namespace softffd {

/// The obstacle at one moment: solid where normal . x < offset.
struct HalfSpace {
  Vec3 point, normal;  ///< [m], unit vector
  double offset;       ///< normal . point [m]
  double gap(const Vec3& x) const { return normal.dot(x) - offset; }
};

struct Plane {
  Vec3 point = Vec3::Zero();             ///< at time `since` [m]
  Vec3 normal = Vec3::UnitZ();           ///< at time `since`, unit length; the solid is on the other side
  Vec3 velocity = Vec3::Zero();          ///< of the obstacle at `point` [m/s]
  Vec3 angular_velocity = Vec3::Zero();  ///< about `point` [rad/s]
  double friction = 0;                   ///< Coulomb coefficient, >= 0
  double since = 0;                      ///< the time that point and normal belong to [s]

  HalfSpace at(double time) const;
  /// Velocity of the obstacle's material at x, for the half-space that `at` returned [m/s].
  Vec3 material_velocity(const HalfSpace& now, const Vec3& x) const;
};

}  // namespace softffd
