#include "contact/contact.hpp"

#include <algorithm>

#include "contact/tolerances.hpp"

namespace softffd {

namespace {

/// Moves x onto the plane.
void snap(const HalfSpace& plane, Vec3& x) { x -= plane.gap(x) * plane.normal; }

/// Coulomb friction of a normal impulse R on a point that slides: opposite to the mean slip, holding if it can.
Vec3 after_friction(double limit, const Vec3& slip_before, const Vec3& slip_after) {
  const double size = slip_after.norm();
  if (size <= limit) return Vec3::Zero();
  const Vec3 mean = slip_before + slip_after;
  const double length = mean.norm();
  return length > 0 ? Vec3(slip_after - limit / length * mean) : Vec3((1 - limit / size) * slip_after);
}

/// Where everything is at rest, velocities are allowed the rounding of this one [m/s].
constexpr double unit_speed = 1;

}  // namespace

Contact::Contact(int points, int planes)
    : start_(planes), middle_(planes), end_(planes), feasible_(planes), gap_(points), marked_(points, 0) {
  touched_.reserve(points);
  constraints_.reserve(planes);
  active_.reserve(planes);
}

StepStatus Contact::clear_jumps(const Body& body, const Drive& around, double time, Points& x, bool& moved) {
  const int n = body.points();
  bool any = false;
  for (std::size_t q = 0; q < around.planes.size(); ++q) {
    start_[q] = around.planes[q].at(time);
    any = kernels::gaps(n, x.data(), start_[q].normal.data(), start_[q].offset, gap_.data()) || any;
  }
  if (!any) return StepStatus::ok;
  for (int p = 0; p < n; ++p) {
    Vec3 here = row(x, p);
    constraints_.clear();
    double least = 0;
    for (const HalfSpace& plane : start_) {
      constraints_.push_back({.normal = plane.normal, .bound = plane.offset});
      least = std::min(least, plane.gap(here));
    }
    if (least >= 0) continue;
    if (body.pinned[p]) {
      if (least < -pin_slack * body.length) return StepStatus::pin_behind_plane;
      continue;
    }
    const double slack = position_slack * (body.length + here.norm());
    if (!feasible_.project(constraints_, slack, here)) return StepStatus::impossible_planes;
    set_row(x, p, here);
    moved = true;
  }
  return StepStatus::ok;
}

StepStatus Contact::drift(const StepView& step, const Points& before, Points& v, Points& x1, Exchange& exchange) {
  touched_.clear();
  const int n = step.body.points();
  for (std::size_t q = 0; q < step.around.planes.size(); ++q) {
    const Plane& plane = step.around.planes[q];
    end_[q] = plane.at(step.t1);
    if (!kernels::gaps(n, x1.data(), end_[q].normal.data(), end_[q].offset, gap_.data())) continue;
    for (int p = 0; p < n; ++p)
      if (gap_[p] < 0 && !marked_[p])
        marked_[p] = 1, touched_.push_back({p, row(step.x0, p), row(before, p), row(step.spring, p) + row(step.force, p)});
  }
  if (touched_.empty()) return StepStatus::ok;
  for (std::size_t q = 0; q < step.around.planes.size(); ++q) {
    start_[q] = step.around.planes[q].at(step.t0);
    middle_[q] = step.around.planes[q].at(0.5 * (step.t0 + step.t1));
  }
  StepStatus status = StepStatus::ok;
  for (Touch& touch : touched_) {
    const int p = touch.point;
    marked_[p] = 0;
    if (status != StepStatus::ok) continue;
    Change change{row(x1, p), row(v, p)};
    status = drift_point(step, touch, change, exchange);
    set_row(x1, p, change.x1);
    set_row(v, p, change.v);
  }
  return status;
}

void Contact::book(Touch& touch, int plane, const Vec3& impulse, const Vec3& x1, Exchange& exchange) const {
  exchange.planes[plane].add(-impulse, x1 - end_[plane].point);
  touch.impulse += impulse;
  touch.surface_work += impulse.dot(end_[plane].material_velocity(x1));
}

int Contact::deepest(const Vec3& x1) const {
  int deepest = 0;
  for (std::size_t q = 1; q < end_.size(); ++q)
    if (end_[q].gap(x1) < end_[deepest].gap(x1)) deepest = int(q);
  return deepest;
}

StepStatus Contact::drift_point(const StepView& step, Touch& touch, Change& change, Exchange& exchange) {
  const int p = touch.point;
  const int plane = deepest(change.x1);
  if (step.body.pinned[p])
    return end_[plane].gap(change.x1) < -pin_slack * step.body.length ? StepStatus::pin_behind_plane : StepStatus::ok;
  const Change free = change;
  Vec3 impulse;
  change = first_contact(step, p, plane, touch.velocity, free, impulse);
  const bool alone =
      std::all_of(end_.begin(), end_.end(), [&](const HalfSpace& other) { return &other == &end_[plane] || other.gap(change.x1) >= 0; });
  if (!alone) return several_contacts(step, touch, free, change, exchange);
  book(touch, plane, impulse, change.x1, exchange);
  return StepStatus::ok;
}

Contact::Change Contact::first_contact(const StepView& step, int p, int plane, const Vec3& before, const Change& free, Vec3& impulse) {
  const HalfSpace& end = end_[plane];
  const Vec3& n = end.normal;
  const Vec3 x0 = row(step.x0, p);
  const double h = step.h, gap0 = start_[plane].gap(x0), gap1 = end.gap(free.x1), mu = step.around.planes[plane].friction;
  const double mass = step.kicks.opening_mass(p);
  const double wall = n.dot(free.v) - (gap1 - gap0) / h;  // normal velocity of the plane where the point is
  const Vec3 wall_t = tangential(n, middle_[plane].material_velocity(x0 + 0.5 * h * free.v));
  if (gap0 > touching * step.body.length) {
    ++impacts_;
    const double theta = gap0 / (gap0 - gap1);
    const Vec3 acceleration = (row(step.spring, p) + row(step.force, p) - step.body.damping[p] * free.v) / step.body.mass[p];
    const Vec3 ahead = (theta - 0.5) * h * acceleration;
    const Vec3 u = free.v + ahead;
    const double reaction = std::max(0.0, wall - n.dot(u));
    const Vec3 slip = tangential(n, u) - wall_t;
    const double size = slip.norm();
    const Vec3 left = size > 0 ? Vec3(std::max(0.0, 1 - mu * reaction / size) * slip) : slip;
    const Vec3 v = (reaction > 0 ? wall : n.dot(u)) * n + wall_t + left;
    Vec3 x1 = x0 + theta * h * free.v + (1 - theta) * h * (wall_t + left);
    snap(end, x1);
    impulse = mass * (v - u);
    return {x1, v - ahead};
  }
  const double reaction = std::max(0.0, wall - n.dot(free.v));
  const Vec3 slip = tangential(n, free.v) - wall_t;
  const Vec3 left = after_friction(mu * reaction, tangential(n, before) - wall_t, slip);
  const Vec3 v = free.v + reaction * n + (left - slip);
  Vec3 x1 = x0 + h * v;
  snap(end, x1);
  impulse = mass * (v - free.v);
  return {x1, v};
}

StepStatus Contact::several_contacts(const StepView& step, Touch& touch, const Change& free, Change& change, Exchange& exchange) {
  const Vec3 x0 = row(step.x0, touch.point);
  const double h = step.h, length = step.body.length;
  constraints_.clear();
  for (std::size_t q = 0; q < end_.size(); ++q) {
    const Plane& plane = step.around.planes[q];
    const double gap0 = start_[q].gap(x0), room = gap0 > touching * length ? 0.0 : gap0;
    constraints_.push_back({.normal = end_[q].normal,
                            .bound = end_[q].normal.dot(free.v) - (end_[q].gap(free.x1) - room) / h,
                            .friction = plane.friction,
                            .surface = middle_[q].material_velocity(x0 + 0.5 * h * free.v)});
  }
  change.v = free.v;
  if (!feasible_.resolve(constraints_, velocity_slack * (length + x0.norm()) / h, change.v)) return StepStatus::impossible_planes;
  change.x1 = x0 + h * change.v;
  push_out(end_, change.x1);
  for (std::size_t q = 0; q < end_.size(); ++q) {
    const Constraint& c = constraints_[q];
    if (c.normal_impulse == 0 && c.friction_impulse.isZero(0)) continue;
    book(touch, int(q), step.kicks.opening_mass(touch.point) * (c.normal_impulse * c.normal + c.friction_impulse), change.x1, exchange);
  }
  return StepStatus::ok;
}

StepStatus Contact::close(const StepView& step, const Points& before, const Points& x1, Points& v, Exchange& exchange) {
  for (Touch& touch : touched_) {
    const int p = touch.point;
    if (step.body.pinned[p]) continue;
    Vec3 velocity = row(v, p);
    const StepStatus status = close_point(step, touch, row(before, p), row(x1, p), velocity, exchange);
    if (status != StepStatus::ok) return status;
    set_row(v, p, velocity);
    ++exchange.contacts_resolved;
    exchange.work += touch.surface_work;
    const Vec3 mean_force = 0.5 * (touch.force + row(step.spring, p) + row(step.force, p)), mean = 0.5 * (touch.velocity + velocity);
    const Vec3 travel = row(x1, p) - touch.x;
    exchange.dissipated += touch.surface_work - touch.impulse.dot(mean) - mean_force.dot(step.h * mean - travel);
  }
  return StepStatus::ok;
}

StepStatus Contact::close_point(const StepView& step, Touch& touch, const Vec3& before, const Vec3& x1, Vec3& v, Exchange& exchange) {
  active_.clear();
  for (std::size_t q = 0; q < end_.size(); ++q)
    if (end_[q].gap(x1) <= touching * step.body.length) active_.push_back(int(q));
  const double mass = step.kicks.closing_mass(touch.point);
  if (active_.size() == 1) {
    const int plane = active_[0];
    const Vec3& n = end_[plane].normal;
    const Vec3 surface = end_[plane].material_velocity(x1);
    const double reaction = std::max(0.0, n.dot(surface) - n.dot(v));
    const Vec3 slip = tangential(n, v - surface);
    const Vec3 left = after_friction(step.around.planes[plane].friction * reaction, tangential(n, before - surface), slip);
    const Vec3 change = reaction * n + (left - slip);
    v += change;
    book(touch, plane, mass * change, x1, exchange);
  } else if (!active_.empty()) {
    constraints_.clear();
    for (const int q : active_) {
      const Vec3 surface = end_[q].material_velocity(x1);
      const Vec3& n = end_[q].normal;
      constraints_.push_back({.normal = n, .bound = n.dot(surface), .friction = step.around.planes[q].friction, .surface = surface});
    }
    if (!feasible_.resolve(constraints_, velocity_slack * (unit_speed + v.norm()), v)) return StepStatus::impossible_planes;
    for (std::size_t i = 0; i < active_.size(); ++i) {
      const Constraint& c = constraints_[i];
      book(touch, active_[i], mass * (c.normal_impulse * c.normal + c.friction_impulse), x1, exchange);
    }
  }
  return StepStatus::ok;
}

Count points_on(const HalfSpace& obstacle, double length, const Points& x) {
  Count count = 0;
  for (int p = 0; p < x.rows(); ++p) count += obstacle.gap(row(x, p)) <= touching * length;
  return count;
}

}  // namespace softffd
