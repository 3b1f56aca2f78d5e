/// Rotations, with a separate sine and cosine: those of the C library differ in the last bit between processors.
#pragma once
#include <array>

#include "model/types.hpp"

namespace softffd {

struct SineCosine {
  double sine, cosine;
};
/// Returns sine and cosine of a finite angle [rad], with the same bits everywhere. For moderate angles the error is below 1e-15.
SineCosine sine_cosine(double angle);

/// Returns the vector v turned by the rotation vector w [rad] about the axis w.
Vec3 rotated(const Vec3& w, const Vec3& v);

/// Returns the vector v turned by the shortest turn from one unit vector to another; from one to its opposite, v itself.
Vec3 swung(const Vec3& from, const Vec3& to, const Vec3& v);

/// Returns the angular velocity [rad/s] of a body whose rotation vector is w [rad] with this time derivative [rad/s].
Vec3 spin_of(const Vec3& w, const Vec3& rate);

/// Returns the unit quaternion (w, x, y, z) of the rotation vector w [rad].
std::array<double, 4> quaternion(const Vec3& w);

/// Returns the unit quaternion of the shortest turn from the third axis to a direction of any length but 0.
std::array<double, 4> swing_from_z(const Vec3& direction);

/// Returns the vector v turned by the unit quaternion (w, x, y, z).
Vec3 rotated(const std::array<double, 4>& quaternion, const Vec3& v);

}  // namespace softffd
