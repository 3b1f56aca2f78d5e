/// Pins: control points attached to a rigid frame, fixed or moved by input.
#pragma once
#include <array>
#include <vector>

#include "model/rotation.hpp"

namespace softffd {

/// Rigid motion of a frame at one moment.
struct Frame {
  Vec3 origin;                        ///< [m]
  std::array<double, 4> orientation;  ///< unit quaternion w x y z
  Vec3 turn;                          ///< rotation vector applied after the orientation [rad]
  Vec3 velocity, spin;                ///< [m/s], [rad/s]

  /// From the origin to a point of the frame [m], world axes.
  Vec3 arm(const Vec3& local) const { return rotated(turn, rotated(orientation, local)); }
  /// Velocity of the frame's material at the end of an arm [m/s].
  Vec3 material_velocity(const Vec3& arm) const;
};

/// The frame at rest has its origin at the centroid of the pinned points' rest positions and the world's axes.
struct Pin {
  std::vector<int> points;                        ///< control points, each in one pin only
  std::vector<Vec3> local;                        ///< their rest positions in the frame [m]
  Vec3 position = Vec3::Zero();                   ///< origin at time `since` [m]
  std::array<double, 4> orientation{1, 0, 0, 0};  ///< at time `since`: unit quaternion w x y z
  Vec3 velocity = Vec3::Zero();                   ///< of the origin, at time `since` [m/s]
  Vec3 angular_velocity = Vec3::Zero();           ///< at time `since` [rad/s]
  Vec3 acceleration = Vec3::Zero();               ///< [m/s2]
  Vec3 angular_acceleration = Vec3::Zero();       ///< [rad/s2]
  std::array<double, 4> orientation_rate{};       ///< where not zero, turns the frame instead of the angular velocity [1/s]
  double since = 0;                               ///< [s]

  Frame at(double time) const;
};

}  // namespace softffd
