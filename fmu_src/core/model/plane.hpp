/// Obstacle planes: rigid half-spaces in rigid motion.
#pragma once
#include "model/rotation.hpp"

namespace softffd {

/// The obstacle at one moment: solid where normal . x < offset.
struct HalfSpace {
  Vec3 point, normal;  ///< [m], unit vector
  double offset;       ///< normal . point [m]
  Vec3 velocity;       ///< of the obstacle at `point` [m/s]
  Vec3 spin;           ///< its angular velocity [rad/s]

  double gap(const Vec3& x) const { return normal.dot(x) - offset; }
  /// Velocity of the obstacle's material at x [m/s].
  Vec3 material_velocity(const Vec3& x) const;
};

/// Pose and motion from time `since` on. The normal turns with the angular velocity, or, where a rate of the normal is given, follows it.
struct Plane {
  Vec3 point = Vec3::Zero();                 ///< at time `since` [m]
  Vec3 normal = Vec3::UnitZ();               ///< at time `since`, unit length; the solid is on the other side
  Vec3 velocity = Vec3::Zero();              ///< of the obstacle at `point`, at time `since` [m/s]
  Vec3 angular_velocity = Vec3::Zero();      ///< about `point`, at time `since` [rad/s]
  Vec3 acceleration = Vec3::Zero();          ///< [m/s2]
  Vec3 angular_acceleration = Vec3::Zero();  ///< [rad/s2]
  Vec3 normal_rate = Vec3::Zero();           ///< time derivative of `normal` before normalising [1/s]
  double friction = 0;                       ///< Coulomb coefficient, >= 0
  double since = 0;                          ///< [s]

  HalfSpace at(double time) const;
};

}  // namespace softffd
