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

/// The unit quaternion (w, x, y, z) of the rotation vector w [rad].
std::array<double, 4> quaternion(const Vec3& w);

/// The vector v turned by the unit quaternion (w, x, y, z).
Vec3 rotated(const std::array<double, 4>& quaternion, const Vec3& v);

/// The vector v as the shortest turn takes it that takes one unit vector to another; unturned where that is any of half a turn.
Vec3 swung(const Vec3& from, const Vec3& to, const Vec3& v);

}  // namespace softffd
