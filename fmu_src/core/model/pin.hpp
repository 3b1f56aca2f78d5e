/// Pins: control points attached to a rigid frame, fixed or moved by input.
#pragma once
#include <algorithm>
#include <array>
#include <vector>

#include "model/free_body.hpp"

namespace softffd {

/// Rigid motion of a frame at one moment.
struct Frame {
  Vec3 origin;                        ///< [m]
  std::array<double, 4> orientation;  ///< unit quaternion w x y z
  Vec3 turn;                          ///< rotation vector applied after the orientation [rad]
  Vec3 velocity, spin;                ///< [m/s], [rad/s]

  /// Returns the vector from the origin to a point of the frame [m], in world axes.
  Vec3 arm(const Vec3& local) const { return rotated(turn, rotated(orientation, local)); }
  /// Returns the vector in the frame's axes that `arm` returns as this one.
  Vec3 local(const Vec3& arm) const;
  /// Returns the velocity of the frame's material at the end of an arm [m/s].
  Vec3 material_velocity(const Vec3& arm) const;
};

/// Pose and motion of the frame at one moment, as a host gives them.
struct PinMotion {
  Vec3 position = Vec3::Zero();                   ///< origin [m]
  std::array<double, 4> orientation{1, 0, 0, 0};  ///< quaternion w x y z of any length but 0
  Vec3 velocity = Vec3::Zero();                   ///< of the origin [m/s]
  Vec3 angular_velocity = Vec3::Zero();           ///< [rad/s]
  Vec3 acceleration = Vec3::Zero();               ///< [m/s2]
  Vec3 angular_acceleration = Vec3::Zero();       ///< [rad/s2]
  std::array<double, 4> orientation_rate{};       ///< if not zero, turns the frame instead of the angular velocity [1/s]
};

/// The motion from time `since` on, with a unit quaternion, and the attached control points. The frame at rest has the world's axes.
struct Pin : PinMotion {
  std::vector<int> points;          ///< control points, each in one pin only
  std::vector<Vec3> local;          ///< their rest positions in the frame [m]
  double since = 0;                 ///< [s]
  const FreeMotion* own = nullptr;  ///< motion of a free part, which replaces all of PinMotion

  Frame at(double time) const;
  /// True if inputs or parameters move the frame during a communication step.
  bool moves() const { return !none(velocity) || bends(); }
  /// True if they turn or accelerate it.
  bool bends() const { return !(none(angular_velocity) && none(acceleration) && none(angular_acceleration) && none(orientation_rate)); }
  /// Returns the frame of the free part in this state.
  Frame frame_of(const FreeState& state) const;

 private:
  static bool none(const auto& values) {
    return std::ranges::all_of(values, [](double value) { return value == 0; });
  }
};

}  // namespace softffd
