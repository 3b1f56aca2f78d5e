#include "plane.hpp"

#include <Eigen/Geometry>

namespace softffd {

HalfSpace Plane::at(double time) const {
  const double age = time - since;
  const Vec3 here = point + age * velocity;
  const Vec3 n = angular_velocity.isZero(0) ? normal : rotated(age * angular_velocity, normal);
  return {here, n, n.dot(here)};
}

Vec3 Plane::material_velocity(const HalfSpace& now, const Vec3& x) const { return velocity + angular_velocity.cross(x - now.point); }

}  // namespace softffd
