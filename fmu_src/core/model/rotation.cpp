#include "model/rotation.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace softffd {

namespace {

/// Taylor series for |a| <= pi / 8: the first neglected terms are below 1e-18.
SineCosine series(double a) {
  const double s = a * a;
  double sine = 0, cosine = 0;
  for (int n = 8; n > 0; --n) {
    sine = (1 + sine) * (-s / (2 * n * (2 * n + 1)));
    cosine = (1 + cosine) * (-s / (2 * n * (2 * n - 1)));
  }
  return {a * (1 + sine), 1 + cosine};
}

}  // namespace

SineCosine sine_cosine(double angle) {
  constexpr double turn = 6.283185307179586476925;
  const double reduced = std::remainder(angle, turn);  // exact
  SineCosine r = series(reduced / 8);
  for (int doubling = 0; doubling < 3; ++doubling) r = {2 * r.sine * r.cosine, (r.cosine - r.sine) * (r.cosine + r.sine)};
  return r;
}

Vec3 rotated(const Vec3& w, const Vec3& v) {
  const double angle = std::sqrt(w.dot(w));
  if (angle == 0) return v;
  const Vec3 axis = w / angle;
  const SineCosine r = sine_cosine(angle);
  return r.cosine * v + r.sine * axis.cross(v) + (1 - r.cosine) * axis.dot(v) * axis;
}

Vec3 swung(const Vec3& from, const Vec3& to, const Vec3& v) {
  const Vec3 axis = from.cross(to);
  const double cosine = from.dot(to);
  if (axis.isZero(0) || cosine <= -1) return v;
  return v + axis.cross(v) + axis.cross(axis.cross(v)) / (1 + cosine);
}

Vec3 spin_of(const Vec3& w, const Vec3& rate) {
  const double angle = std::sqrt(w.dot(w));
  if (angle == 0) return rate;
  const Vec3 axis = w / angle, along = axis.dot(rate) * axis;
  const SineCosine half = sine_cosine(0.5 * angle);
  return along + 2 * half.sine / angle * (half.cosine * (rate - along) + half.sine * axis.cross(rate));
}

std::array<double, 4> quaternion(const Vec3& w) {
  const double angle = std::sqrt(w.dot(w));
  if (angle == 0) return {1, 0, 0, 0};
  const SineCosine half = sine_cosine(0.5 * angle);
  const Vec3 axis = (half.sine / angle) * w;
  return {half.cosine, axis[0], axis[1], axis[2]};
}

std::array<double, 4> swing_from_z(const Vec3& direction) {
  const Vec3 to = direction / std::sqrt(direction.squaredNorm());
  const double w = std::sqrt(std::max(0.5 * (1 + to[2]), 0.0));  // cosine of half the angle
  if (w == 0) return {0, 1, 0, 0};
  return {w, -0.5 * to[1] / w, 0.5 * to[0] / w, 0};
}

Vec3 rotated(const std::array<double, 4>& q, const Vec3& v) {
  const Vec3 u(q[1], q[2], q[3]);
  const Vec3 t = 2 * u.cross(v);
  return v + q[0] * t + u.cross(t);
}

}  // namespace softffd
