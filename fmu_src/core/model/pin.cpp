#include "model/pin.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace softffd {

Vec3 Frame::material_velocity(const Vec3& arm) const { return velocity + spin.cross(arm); }

Vec3 Frame::local(const Vec3& arm) const {
  const auto& [w, x, y, z] = orientation;
  return rotated(std::array{w, -x, -y, -z}, rotated(-turn, arm));
}

namespace {

/// Vector part of 2 p q* for quaternions w x y z: the angular velocity of a rate p at orientation q.
Vec3 angular_velocity_of(const std::array<double, 4>& p, const std::array<double, 4>& q) {
  const Vec3 pv(p[1], p[2], p[3]), qv(q[1], q[2], q[3]);
  return 2 * (q[0] * pv - p[0] * qv - pv.cross(qv));
}

}  // namespace

Frame Pin::frame_of(const FreeState& state) const {
  const FreeState here = own->own(state);
  return {here.position, here.orientation, Vec3::Zero(), here.velocity, own->spin(state)};
}

Frame Pin::at(double time) const {
  if (own) return frame_of(own->at(time));
  const double age = time - since;
  const Vec3 origin = position + age * (velocity + 0.5 * age * acceleration), speed = velocity + age * acceleration;
  double squared = 0;
  for (double rate : orientation_rate) squared += rate * rate;
  if (squared == 0)
    return {origin, orientation, age * (angular_velocity + 0.5 * age * angular_acceleration), speed,
            angular_velocity + age * angular_acceleration};
  std::array<double, 4> q, rate = orientation_rate;
  squared = 0;
  for (int i = 0; i < 4; ++i) {
    q[i] = orientation[i] + age * rate[i];
    squared += q[i] * q[i];
  }
  for (int i = 0; i < 4; ++i) {
    q[i] /= std::sqrt(squared);
    rate[i] /= std::sqrt(squared);
  }
  return {origin, q, Vec3::Zero(), speed, angular_velocity_of(rate, q)};
}

}  // namespace softffd
