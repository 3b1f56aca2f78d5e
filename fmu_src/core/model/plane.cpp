#include "model/plane.hpp"

#include <Eigen/Geometry>

namespace softffd {

Vec3 HalfSpace::material_velocity(const Vec3& x) const { return velocity + spin.cross(x - point); }

HalfSpace Plane::at(double time) const {
  const double age = time - since;
  const Vec3 here = point + age * (velocity + 0.5 * age * acceleration);
  const Vec3 speed = velocity + age * acceleration;
  if (!normal_rate.isZero(0)) {
    const Vec3 n = normal + age * normal_rate;
    const double squared = n.squaredNorm();
    const Vec3 unit = n / std::sqrt(squared);
    return {here, unit, unit.dot(here), speed, n.cross(normal_rate) / squared};
  }
  const Vec3 turn = age * (angular_velocity + 0.5 * age * angular_acceleration);
  const Vec3 n = turn.isZero(0) ? normal : rotated(turn, normal);
  return {here, n, n.dot(here), speed, angular_velocity + age * angular_acceleration};
}

}  // namespace softffd
