/// How a deformed body is turned from its rest shape.
#pragma once
#include "model/types.hpp"

namespace softffd {

/// The rotation next to a: its polar factor (Higham 1986). Unity for a matrix that is no deformed rotation; any frame will do.
Eigen::Matrix3d rotation_next_to(const Eigen::Matrix3d& a);

/// The rotation by the vector turn [rad] about its axis.
Eigen::Matrix3d rotation_by(const Vec3& turn);

}  // namespace softffd
