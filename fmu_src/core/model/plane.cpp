#include "model/plane.hpp"

#include <algorithm>
#include <cmath>

namespace softffd {

HalfSpace Plane::at(double time) const {
  const double age = time - since;
  const Vec3 here = point + age * (velocity + 0.5 * age * acceleration);
  const Vec3 speed = velocity + age * acceleration;
  if (!normal_rate.isZero(0)) {
    const Vec3 n = normal + age * normal_rate;
    const double squared = n.squaredNorm();
    const Vec3 unit = n / std::sqrt(squared);
    HalfSpace there{here, unit, unit.dot(here), speed, n.cross(normal_rate) / squared};
    if (box()) there.across = swung(normal, unit, swung(upright, normal, across));
    return there;
  }
  const Vec3 turn = age * (angular_velocity + 0.5 * age * angular_acceleration);
  const Vec3 n = turn.isZero(0) ? normal : rotated(turn, normal);
  HalfSpace there{here, n, n.dot(here), speed, angular_velocity + age * angular_acceleration};
  if (box()) {
    const Vec3 begin = swung(upright, normal, across);
    there.across = turn.isZero(0) ? begin : rotated(turn, begin);
  }
  return there;
}

bool Plane::at_rest() const {
  return velocity.isZero(0) && angular_velocity.isZero(0) && acceleration.isZero(0) && angular_acceleration.isZero(0) &&
         normal_rate.isZero(0);
}

namespace {

/// Largest rates of the unit normal [1/s, 1/s2].
struct Turning {
  double rate, bend;
};

/// Of a normal N + age R: it turns by |N x R| / N^2.
Turning turning_by_rate(const Plane& plane, double a0, double a1) {
  const Vec3 &N = plane.normal, &R = plane.normal_rate;
  const double nearest = std::clamp(-N.dot(R) / R.squaredNorm(), std::min(a0, a1), std::max(a0, a1));
  const double least = (N + nearest * R).squaredNorm(), across = N.cross(R).norm() / least;
  return {across, across * (across + 2 * R.norm() / std::sqrt(least))};
}

/// Of a rotation vector w age + alpha age^2 / 2, whose derivative bounds the angular velocity.
Turning turning_by_spin(const Plane& plane, double a0, double a1) {
  const auto at = [&](double age) { return (plane.angular_velocity + age * plane.angular_acceleration).norm(); };
  const double rate = std::max(at(a0), at(a1));
  return {rate, plane.angular_acceleration.norm() + 2 * rate * rate};
}

}  // namespace

/// The gap n . (x - p) has the second derivative n'' . (x - p) - 2 n' . p' - n . p''.
PlaneWay way_between(const Plane& plane, double t0, double t1, double arm) {
  const double a0 = t0 - plane.since, a1 = t1 - plane.since, h = t1 - t0;
  const Turning turning = plane.normal_rate.isZero(0) ? turning_by_spin(plane, a0, a1) : turning_by_rate(plane, a0, a1);
  const double speed = std::max((plane.velocity + a0 * plane.acceleration).norm(), (plane.velocity + a1 * plane.acceleration).norm());
  const double reach = arm + h * speed;
  return {speed + turning.rate * reach, h * h / 8 * (plane.acceleration.norm() + 2 * turning.rate * speed + turning.bend * reach)};
}

}  // namespace softffd
