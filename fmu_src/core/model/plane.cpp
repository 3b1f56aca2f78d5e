#include "model/plane.hpp"

#include <algorithm>
#include <cmath>

namespace softffd {

namespace {

/// The edges of a box, and its angular velocity.
struct Turned {
  Eigen::Matrix3d edges;
  Vec3 spin;
};

Turned turned_box(const Plane& box, double age) {
  const Vec3 rotation = box.rotation + age * box.rotation_rate;
  const Vec3 turn = age * (box.angular_velocity + 0.5 * age * box.angular_acceleration);
  const bool follows = !box.rotation_rate.isZero(0);
  Turned now{{}, follows ? spin_of(rotation, box.rotation_rate) : Vec3(box.angular_velocity + age * box.angular_acceleration)};
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 edge = rotated(rotation, Vec3::Unit(axis));
    now.edges.col(axis) = follows ? edge : rotated(turn, edge);
  }
  return now;
}

/// Returns the supporting half-space of the solid whose normal moves with the solid.
HalfSpace supporting(const Plane& solid, const SolidPose& pose) {
  Vec3 normal = solid.facing;
  double beyond = solid.radius;
  if (solid.box()) {
    normal = pose.edges * solid.facing;
    beyond = 0.5 * solid.sides.dot(solid.facing.cwiseAbs());
  } else if (solid.length > 0) {
    normal = swung(solid.normal, pose.normal, solid.facing);
    const double along = normal.dot(pose.normal);
    beyond = solid.radius * (normal - along * pose.normal).norm() + 0.5 * solid.length * std::abs(along);
  }
  return {pose.point, normal, normal.dot(pose.point) + beyond, pose.velocity, pose.spin};
}

}  // namespace

HalfSpace Plane::at(double time) const {
  if (stood_for()) return supporting(*this, pose_at(time));
  return pose_at(time);
}

SolidPose Plane::pose_at(double time) const {
  if (own) return pose_of(own->at(time));
  const double age = time - since;
  const Vec3 here = point + age * (velocity + 0.5 * age * acceleration);
  const Vec3 speed = velocity + age * acceleration;
  if (box()) {
    const auto [edges, spin] = turned_box(*this, age);
    const Vec3 up = edges.col(2);
    return {{here, up, up.dot(here) + 0.5 * sides[2], speed, spin}, edges};
  }
  if (!normal_rate.isZero(0)) {
    const Vec3 n = normal + age * normal_rate;
    const double squared = n.squaredNorm();
    const Vec3 unit = n / std::sqrt(squared);
    return {{here, unit, unit.dot(here), speed, n.cross(normal_rate) / squared}, {}};
  }
  const Vec3 turn = age * (angular_velocity + 0.5 * age * angular_acceleration);
  const Vec3 n = turn.isZero(0) ? normal : rotated(turn, normal);
  return {{here, n, n.dot(here), speed, angular_velocity + age * angular_acceleration}, {}};
}

SolidPose Plane::pose_of(const FreeState& state) const {
  const Eigen::Matrix3d edges = axes_of(state.orientation);
  const Vec3 up = edges.col(2);
  const double beyond = box() ? 0.5 * sides[2] : 0;
  return {{state.position, up, up.dot(state.position) + beyond, state.velocity, own->spin(state)}, edges};
}

bool Plane::holds(const SolidPose& pose, const Vec3& x, double slack) const {
  const Vec3 arm = x - pose.point;
  if (box()) return ((pose.edges.transpose() * arm).cwiseAbs() - 0.5 * sides).maxCoeff() <= slack;
  if (length == 0) return arm.norm() <= radius + slack;
  const double height = pose.normal.dot(arm);
  return std::abs(height) <= 0.5 * length + slack && (arm - height * pose.normal).norm() <= radius + slack;
}

bool Plane::at_rest() const {
  return !own && velocity.isZero(0) && angular_velocity.isZero(0) && acceleration.isZero(0) && angular_acceleration.isZero(0) &&
         normal_rate.isZero(0) && rotation_rate.isZero(0);
}

bool Plane::bends() const {
  return !own && !(angular_velocity.isZero(0) && acceleration.isZero(0) && angular_acceleration.isZero(0) && normal_rate.isZero(0) &&
                   rotation_rate.isZero(0));
}

namespace {

/// Largest first and second derivative of the unit normal in time [1/s, 1/s2].
struct Turning {
  double rate, bend;
};

/// Returns the rates of a normal N + age R, which turns at |N x R| / N^2.
Turning turning_by_rate(const Plane& plane, double a0, double a1) {
  const Vec3 &N = plane.normal, &R = plane.normal_rate;
  const double nearest = std::clamp(-N.dot(R) / R.squaredNorm(), std::min(a0, a1), std::max(a0, a1));
  const double least = (N + nearest * R).squaredNorm(), across = N.cross(R).norm() / least;
  return {across, across * (across + 2 * R.norm() / std::sqrt(least))};
}

/// Returns the rates of a rotation vector w age + alpha age^2 / 2, or of a box's own, whose derivative bounds the angular velocity.
Turning turning_by_spin(const Plane& plane, double a0, double a1) {
  if (const double rate = plane.rotation_rate.norm(); rate > 0) return {rate, 2 * rate * rate};
  const auto at = [&](double age) { return (plane.angular_velocity + age * plane.angular_acceleration).norm(); };
  const double rate = std::max(at(a0), at(a1));
  return {rate, plane.angular_acceleration.norm() + 2 * rate * rate};
}

}  // namespace

/// The gap n . (x - p) has the second derivative n'' . (x - p) - 2 n' . p' - n . p''.
PlaneWay way_between(const Plane& plane, double t0, double t1, double arm) {
  if (plane.own) {
    const FreeState start = plane.own->at(t0), end = plane.own->at(t1);
    const double spin = std::max(plane.own->spin(start).norm(), plane.own->spin(end).norm());
    const double fastest = std::max(start.velocity.norm(), end.velocity.norm()), far = arm + (t1 - t0) * fastest;
    const double force = std::max(plane.own->loads(start).force.norm(), plane.own->loads(end).force.norm());
    const double bend = force / plane.own->mass() + 2 * spin * fastest + 2 * spin * spin * far;
    return {fastest + spin * far, (t1 - t0) * (t1 - t0) / 8 * bend};
  }
  const double a0 = t0 - plane.since, a1 = t1 - plane.since, h = t1 - t0;
  const Turning turning = plane.normal_rate.isZero(0) ? turning_by_spin(plane, a0, a1) : turning_by_rate(plane, a0, a1);
  const double speed = std::max((plane.velocity + a0 * plane.acceleration).norm(), (plane.velocity + a1 * plane.acceleration).norm());
  const double reach = arm + h * speed;
  return {speed + turning.rate * reach, h * h / 8 * (plane.acceleration.norm() + 2 * turning.rate * speed + turning.bend * reach)};
}

}  // namespace softffd
