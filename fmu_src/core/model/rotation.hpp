/// Rotations, with a sine and cosine of our own: those of the C library differ in the last bit between processors.
#pragma once
#include <array>

#include "model/types.hpp"

namespace softffd {

struct SineCosine {
  double sine, cosine;
};
/// Sine and cosine of a finite angle [rad], error below 1e-15 for moderate angles; the same bits everywhere.
SineCosine sine_cosine(double angle);

/// The vector v turned by the rotation vector w [rad] about the axis w.
Vec3 rotated(const Vec3& w, const Vec3& v);

/// The vector v as the shortest turn from one unit vector to another takes it; from one to its opposite: v itself.
Vec3 swung(const Vec3& from, const Vec3& to, const Vec3& v);

/// The angular velocity [rad/s] of what a rotation vector w turns whose time derivative is this [rad/s].
Vec3 spin_of(const Vec3& w, const Vec3& rate);

/// The unit quaternion (w, x, y, z) of the rotation vector w [rad].
std::array<double, 4> quaternion(const Vec3& w);

/// The same of the shortest turn from the third axis to a direction of any length but 0.
std::array<double, 4> swing_from_z(const Vec3& direction);

/// The vector v turned by the unit quaternion (w, x, y, z).
Vec3 rotated(const std::array<double, 4>& quaternion, const Vec3& v);

}  // namespace softffd
