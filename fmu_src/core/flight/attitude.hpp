/// Rotation of a deformed body relative to its rest shape.
#pragma once
#include "model/types.hpp"

namespace softffd {

/// Returns the rotation closest to a, its polar factor (Higham 1986); the identity if a is no deformed rotation, where any frame will do.
Eigen::Matrix3d rotation_next_to(const Eigen::Matrix3d& a);

/// Returns the rotation about the axis `turn` by its length [rad].
Eigen::Matrix3d rotation_by(const Vec3& turn);

}  // namespace softffd
