/// Reactions of the body on the outside during one communication step.
#pragma once
#include <algorithm>
#include <vector>

#include "model/plane.hpp"
#include "model/visit.hpp"

namespace softffd {

/// Time integral of a force and of its torque.
struct Impulse {
  Vec3 force = Vec3::Zero();   ///< [N s]
  Vec3 torque = Vec3::Zero();  ///< [N m s]
  double pressed = 0;          ///< of a solid: sum of the impulses along its normals [N s]
  Vec3 places = Vec3::Zero();  ///< of a solid: sum of the arms, weighted by the impulse along the normal there [N m s]
  void add(const Vec3& impulse, const Vec3& arm) {
    force += impulse;
    torque += arm.cross(impulse);
  }
  void press(double along, const Vec3& arm) {
    pressed += along;
    places += along * arm;
  }
  Wrench mean(double time) const { return {force / time, torque / time}; }
  Impulse& operator+=(const Impulse& other) {
    force += other.force;
    torque += other.torque;
    pressed += other.pressed;
    places += other.places;
    return *this;
  }

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.force, s.torque, s.pressed, s.places);
  }
};
static_assert(visits_every_field<Impulse>);

/// Returns the point of an obstacle [m] at which an impulse acts, with torque about the obstacle's point: about the returned point the
/// torque has no part along the plane. Impulses that press at points of the plane act at the mean of the points, weighted by how much each
/// presses. If no impulse presses, the point is the obstacle's point.
inline Vec3 centre_of_pressure(const HalfSpace& plane, const Impulse& on) {
  const double pressing = -plane.normal.dot(on.force);
  const Vec3 arm = plane.normal.cross(on.torque) / -pressing;
  return pressing > 0 && arm.allFinite() ? plane.point + arm : plane.point;
}

/// Returns the same for a solid, which has no common plane [m]: the mean of the touched places, weighted by how much each presses.
inline Vec3 centre_of_places(const HalfSpace& pose, const Impulse& on) {
  const Vec3 arm = on.places / on.pressed;
  return on.pressed > 0 && arm.allFinite() ? Vec3(pose.point + arm) : pose.point;
}

/// Reading of a followed point in the current communication step.
struct PointReading {
  Vec3 acceleration = Vec3::Zero();  ///< mean [m/s2]
  // largest values:
  double speed = 0;                 ///< [m/s]
  double largest_acceleration = 0;  ///< largest mean over one interval [m/s2]
  double von_mises = 0;             ///< only if the stress is wanted [Pa]
  Vec3 begun = Vec3::Zero();        ///< velocity at the start of the time of the next mean [m/s]
  Vec3 from = Vec3::Zero();         ///< velocity at the start of the current interval [m/s]
  double since = 0;                 ///< time since the start of that interval [s]

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.acceleration, s.speed, s.largest_acceleration, s.von_mises, s.begun, s.from, s.since);
  }
};
static_assert(visits_every_field<PointReading>);

/// What the outside received during the current communication step. Energies accumulate only if they are asked for.
struct Exchange {
  std::vector<Impulse> planes;  ///< impulses of the body on each obstacle, torque about the plane's point
  std::vector<Impulse> pins;    ///< impulses of the body on each fixture, torque about the frame's origin
  std::vector<Points> touched;  ///< impulses of each obstacle on each control point or surface sample [N s]; empty unless a sensor asks
  std::vector<PointReading> points;  ///< followed points
  double dissipated = 0;             ///< energy lost to damping, friction and impacts [J]
  double work = 0;                   ///< work of moving obstacles and pins on the body [J]
  Count contacts_resolved = 0;

  /// Books an impulse [N s] that an obstacle or a pin gives the body at the end of an arm [m], where the obstacle or pin has a velocity
  /// [m/s]: `taker` gets the reaction, and `work` the work on the body.
  void push(Impulse& taker, const Vec3& impulse, const Vec3& arm, const Vec3& velocity) {
    taker.add(-impulse, arm);
    work += impulse.dot(velocity);
  }
  /// Books an impulse [N s] that an obstacle gives a control point or a sample.
  void touch(std::size_t obstacle, int at, const Vec3& impulse) {
    if (!touched.empty()) touched[obstacle].row(at) += impulse.array().transpose();
  }
  /// Resets what a communication step collects, but for impulses of obstacles or pins that wait for their means (watch/means.hpp).
  void clear(bool planes_wait = false, bool pins_wait = false) {
    dissipated = work = 0;
    contacts_resolved = 0;
    if (!pins_wait) std::ranges::fill(pins, Impulse{});
    if (planes_wait) return;
    std::ranges::fill(planes, Impulse{});
    for (Points& impulses : touched) impulses.setZero();
  }

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.planes, s.pins, s.touched, s.points, s.dissipated, s.work, s.contacts_resolved);
  }
};
static_assert(visits_every_field<Exchange>);

}  // namespace softffd
