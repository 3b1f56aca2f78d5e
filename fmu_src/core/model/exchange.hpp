/// What the body gives back to the outside during one communication step.
#pragma once
#include <vector>

#include "model/plane.hpp"
#include "model/visit.hpp"

namespace softffd {

/// Time integral of a force and of its torque.
struct Impulse {
  Vec3 force = Vec3::Zero();   ///< [N s]
  Vec3 torque = Vec3::Zero();  ///< [N m s]
  double pressed = 0;          ///< of a solid: the parts along its normals, summed [N s]
  Vec3 places = Vec3::Zero();  ///< of a solid: the arms, each times the part along the normal there [N m s]
  void add(const Vec3& impulse, const Vec3& arm) {
    force += impulse;
    torque += arm.cross(impulse);
  }
  void press(double along, const Vec3& arm) {
    pressed += along;
    places += along * arm;
  }
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

/// The point of an obstacle [m] where an impulse on it acts, its torque about the obstacle's point: about that point the torque has no part
/// along the plane. Impulses that press, at points of the plane, act at the mean of the points, weighted by how much each presses. Without
/// one that presses: the obstacle's point.
inline Vec3 centre_of_pressure(const HalfSpace& plane, const Impulse& on) {
  const double pressing = -plane.normal.dot(on.force);
  const Vec3 arm = plane.normal.cross(on.torque) / -pressing;
  return pressing > 0 && arm.allFinite() ? plane.point + arm : plane.point;
}

/// The same of a solid, which has no plane for all of them [m]: the mean of the touched places, weighted by how much each presses.
inline Vec3 centre_of_places(const HalfSpace& pose, const Impulse& on) {
  const Vec3 arm = on.places / on.pressed;
  return on.pressed > 0 && arm.allFinite() ? Vec3(pose.point + arm) : pose.point;
}

/// Of a point that is followed, in the current communication step.
struct PointReading {
  Vec3 acceleration = Vec3::Zero();  ///< mean [m/s2]
  // the largest:
  double speed = 0;                 ///< [m/s]
  double largest_acceleration = 0;  ///< of means over some time [m/s2]
  double von_mises = 0;             ///< where the stress is wanted [Pa]
  Vec3 from = Vec3::Zero();         ///< velocity when that time began [m/s]
  double since = 0;                 ///< [s]

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.acceleration, s.speed, s.largest_acceleration, s.von_mises, s.from, s.since);
  }
};
static_assert(visits_every_field<PointReading>);

/// What the outside received during the current communication step. Energies only accumulate when they are asked for.
struct Exchange {
  std::vector<Impulse> planes;       ///< of the body on each obstacle, torque about the plane's point
  std::vector<Impulse> pins;         ///< of the body on each fixture, torque about the frame's origin
  std::vector<Points> touched;       ///< by each obstacle on each control point, or sample of the surface [N s]; none where no sensor asks
  std::vector<PointReading> points;  ///< that are followed
  double dissipated = 0;             ///< energy lost to damping, friction and impacts [J]
  double work = 0;                   ///< work of moving obstacles and pins on the body [J]
  Count contacts_resolved = 0;

  /// Whoever holds or stops the body gives it an impulse [N s] at the end of an arm [m], moving with a velocity [m/s]: takes the reaction,
  /// and works.
  void push(Impulse& taker, const Vec3& impulse, const Vec3& arm, const Vec3& velocity) {
    taker.add(-impulse, arm);
    work += impulse.dot(velocity);
  }
  /// An obstacle gives a control point, or a sample, an impulse [N s].
  void touch(std::size_t obstacle, int at, const Vec3& impulse) {
    if (!touched.empty()) touched[obstacle].row(at) += impulse.array().transpose();
  }
  /// Nothing yet in this communication step.
  void clear() {
    for (auto* impulses : {&planes, &pins})
      for (Impulse& impulse : *impulses) impulse = {};
    for (Points& impulses : touched) impulses.setZero();
    dissipated = work = 0;
    contacts_resolved = 0;
  }

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.planes, s.pins, s.touched, s.points, s.dissipated, s.work, s.contacts_resolved);
  }
};
static_assert(visits_every_field<Exchange>);

}  // namespace softffd
