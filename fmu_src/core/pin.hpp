/// Pins: control points attached to a rigid frame, fixed or moved by input.
#pragma once
#include <array>
#include <vector>

#include "rotation.hpp"

namespace softffd {

/// The frame at rest has its origin at the centroid of the pinned points' rest positions and the world's axes.
struct Pin {
  std::vector<int> points;                        ///< control points, each in one pin only
  std::vector<Vec3> local;                        ///< their rest positions in the frame [m]
  Vec3 position = Vec3::Zero();                   ///< origin at time `since` [m]
  std::array<double, 4> orientation{1, 0, 0, 0};  ///< at time `since`: unit quaternion w x y z
  Vec3 velocity = Vec3::Zero();                   ///< of the origin [m/s]
  Vec3 angular_velocity = Vec3::Zero();           ///< [rad/s]
  double since = 0;                               ///< [s]

  Vec3 origin(double time) const { return position + (time - since) * velocity; }
  /// The arm from the frame's origin to pinned point number n at a time [m].
  Vec3 arm(int n, double time) const { return rotated((time - since) * angular_velocity, rotated(orientation, local[n])); }
  /// Velocity of the frame's material at the end of an arm [m/s].
  Vec3 material_velocity(const Vec3& arm) const;
};

}  // namespace softffd
