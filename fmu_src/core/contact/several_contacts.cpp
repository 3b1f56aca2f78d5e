/// Contact of points that meet several planes: the points are projected exactly onto all of them, one point after the other.
#include "contact/contact.hpp"
#include "contact/tolerances.hpp"

namespace softffd {

namespace {

/// Speed that is added to the point's own in the rounding allowed to velocities, so that some is allowed at rest too [m/s].
constexpr double unit_speed = 1;

}  // namespace

/// Returns the bits of the lanes whose points are behind no plane other than the octet's.
unsigned Contact::alone_after_drift(const Octet& octet) const {
  unsigned lanes = octet.all();
  for (int q = 0; q < int(end_.size()); ++q)
    if (q != octet.plane) lanes &= sides(end_[q], octet, 0).at_least;
  return lanes;
}

/// Returns the bits of the lanes whose points touch the octet's plane and no other.
unsigned Contact::alone_at_the_end(const Octet& octet, double contact) const {
  unsigned lanes = octet.all();
  for (int q = 0; q < int(end_.size()); ++q) {
    const Sides found = sides(end_[q], octet, contact);
    lanes &= q == octet.plane ? found.at_most : found.at_least & ~found.at_most;
  }
  return lanes;
}

void Contact::book(Octet& octet, int lane, int plane, const Vec3& impulse, const Vec3& x1, Exchange& exchange) const {
  exchange.planes[plane].add(-impulse, x1 - end_[plane].point);
  exchange.touch(plane, octet.point[lane], impulse);
  set_lane(octet.received, lane, lane_of(octet.received, lane) + impulse);
  octet.work[lane] += impulse.dot(end_[plane].material_velocity(x1));
}

/// To be called after the octet's own plane has been met: books the points that are behind no other plane, and corrects the others.
StepStatus Contact::drift_lanes(const StepView& step, const Points& v, const Points& x1, Octet& octet, Exchange& exchange) {
  const unsigned alone = alone_after_drift(octet);
  book(octet, alone, exchange);
  for (int lane = 0; lane < octet.count; ++lane) {
    if (alone >> lane & 1) continue;
    Vec3 here = row(x1, octet.point[lane]), velocity = row(v, octet.point[lane]);
    const StepStatus status = drift_lane(step, octet, lane, here, velocity, exchange);
    if (status != StepStatus::ok) return status;
    set_lane(octet.x1, lane, here);
    set_lane(octet.v, lane, velocity);
  }
  octet.alone = alone_at_the_end(octet, touching * step.body.length);
  return StepStatus::ok;
}

/// Corrects a point that the drift takes behind several planes.
StepStatus Contact::drift_lane(const StepView& step, Octet& octet, int lane, Vec3& x1, Vec3& v, Exchange& exchange) {
  const Vec3 x0 = lane_of(octet.x0, lane), free_x1 = x1, free_v = v;
  const double h = step.h, length = step.body.length;
  constraints_.clear();
  for (std::size_t q = 0; q < end_.size(); ++q) {
    const Plane& plane = step.around.planes[q];
    const double gap0 = approach_[q].start.gap(x0), room = gap0 > touching * length ? 0.0 : gap0;
    constraints_.push_back({.normal = end_[q].normal,
                            .bound = end_[q].normal.dot(free_v) - (end_[q].gap(free_x1) - room) / h,
                            .friction = plane.friction,
                            .surface = approach_[q].middle.material_velocity(x0 + 0.5 * h * free_v)});
  }
  if (!feasible_.resolve(constraints_, velocity_slack * (length + x0.norm()) / h, v)) return StepStatus::impossible_planes;
  x1 = x0 + h * v;
  push_out(end_, x1);
  set_lane(octet.received, lane, Vec3::Zero());
  octet.work[lane] = 0;
  for (std::size_t q = 0; q < end_.size(); ++q) {
    const Constraint& c = constraints_[q];
    if (c.normal_impulse == 0 && c.friction_impulse.isZero(0)) continue;
    book(octet, lane, int(q), octet.opening[lane] * (c.normal_impulse * c.normal + c.friction_impulse), x1, exchange);
  }
  return StepStatus::ok;
}

/// Corrects v after the closing half kick for an octet in which not all points touch the octet's plane alone.
StepStatus Contact::close_lanes(const StepView& step, Points& v, Octet& octet, Exchange& exchange) {
  before_closing_ = octet;
  velocity_stage(approach_[octet.plane], v, step.spring, step.force, octet);
  book(octet, octet.alone, exchange);
  for (int lane = 0; lane < octet.count; ++lane) {
    if (octet.alone >> lane & 1) continue;
    const StepStatus status = close_lane(step, v, octet, lane, exchange);
    if (status != StepStatus::ok) return status;
  }
  account_energy(step.h, octet, v);
  return StepStatus::ok;
}

StepStatus Contact::close_lane(const StepView& step, const Points& kicked, Octet& octet, int lane, Exchange& exchange) {
  const Vec3 x1 = lane_of(octet.x1, lane);
  active_.clear();
  for (std::size_t q = 0; q < end_.size(); ++q)
    if (end_[q].gap(x1) <= touching * step.body.length) active_.push_back(int(q));
  if (active_.size() == 1) {
    Octet other = before_closing_;
    velocity_stage(approach_[active_[0]], kicked, step.spring, step.force, other);
    octet.take(lane, other);
    other.plane = active_[0];
    book(other, 1u << lane, exchange);
    return StepStatus::ok;
  }
  Vec3 v = row(kicked, octet.point[lane]);
  octet.take(lane, before_closing_);
  set_lane(octet.v, lane, v);
  if (active_.empty()) return StepStatus::ok;
  constraints_.clear();
  for (const int q : active_) {
    const Vec3 surface = end_[q].material_velocity(x1);
    const Vec3& n = end_[q].normal;
    constraints_.push_back({.normal = n, .bound = n.dot(surface), .friction = approach_[q].friction, .surface = surface});
  }
  if (!feasible_.resolve(constraints_, velocity_slack * (unit_speed + v.norm()), v)) return StepStatus::impossible_planes;
  set_lane(octet.v, lane, v);
  for (std::size_t i = 0; i < active_.size(); ++i) {
    const Constraint& c = constraints_[i];
    book(octet, lane, active_[i], octet.closing[lane] * (c.normal_impulse * c.normal + c.friction_impulse), x1, exchange);
  }
  return StepStatus::ok;
}

}  // namespace softffd
