#include "pin.hpp"

#include <Eigen/Geometry>

namespace softffd {

Vec3 Pin::material_velocity(const Vec3& arm) const { return velocity + angular_velocity.cross(arm); }

}  // namespace softffd
