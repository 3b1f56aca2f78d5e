#include "contact/contact.hpp"

#include <algorithm>
#include <bit>
#include <numeric>

#include "contact/tolerances.hpp"

namespace softffd {

namespace {

/// Where everything is at rest, velocities are allowed the rounding of this one [m/s].
constexpr double unit_speed = 1;

}  // namespace

Contact::Contact(int points, int planes)
    : start_(planes),
      end_(planes),
      approach_(planes),
      octets_(planes > 0 ? points / Octet::lanes + planes : 0),
      open_(planes),
      feasible_(planes),
      gap_(points),
      marked_(points, 0) {
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
  find(step, x1);
  if (touched_.empty()) return StepStatus::ok;
  for (std::size_t q = 0; q < step.around.planes.size(); ++q) {
    const Plane& plane = step.around.planes[q];
    approach_[q] = {plane.at(step.t0), plane.at(0.5 * (step.t0 + step.t1)), end_[q], plane.friction, step.h};
  }
  if (!gather(step, before, v, x1)) return StepStatus::pin_behind_plane;
  for (int o = 0; o < used_; ++o) {
    Octet& octet = octets_[o];
    impacts_ += std::popcount(meet(approach_[octet.plane], touching * step.body.length, octet));
    const unsigned alone = lanes_where(octet, [&](int q, double gap) { return q == octet.plane || gap >= 0; });
    book(octet, alone, exchange.planes[octet.plane]);
    for (int lane = 0; lane < octet.count; ++lane) {
      if (alone >> lane & 1) continue;
      Vec3 here = row(x1, octet.point[lane]), velocity = row(v, octet.point[lane]);
      const StepStatus status = several_contacts(step, octet, lane, here, velocity, exchange);
      if (status != StepStatus::ok) return status;
      set_lane(octet.x1, lane, here);
      set_lane(octet.v, lane, velocity);
    }
    octet.put(octet.x1, x1);
    octet.put(octet.v, v);
  }
  return StepStatus::ok;
}

void Contact::find(const StepView& step, const Points& x1) {
  touched_.clear();
  used_ = 0;
  const int n = step.body.points();
  for (std::size_t q = 0; q < step.around.planes.size(); ++q) {
    end_[q] = step.around.planes[q].at(step.t1);
    if (!kernels::gaps(n, x1.data(), end_[q].normal.data(), end_[q].offset, gap_.data())) continue;
    for (int p = 0; p < n; ++p)
      if (gap_[p] < 0 && !marked_[p]) marked_[p] = 1, touched_.push_back(p);
  }
  for (const int p : touched_) marked_[p] = 0;
}

bool Contact::gather(const StepView& step, const Points& before, const Points& v, const Points& x1) {
  std::fill(open_.begin(), open_.end(), -1);
  for (const int p : touched_) {
    const int plane = end_.size() == 1 ? 0 : deepest(row(x1, p));
    if (step.body.pinned[p]) {
      if (end_[plane].gap(row(x1, p)) < -pin_slack * step.body.length) return false;
      continue;
    }
    if (open_[plane] < 0 || octets_[open_[plane]].count == Octet::lanes) {
      open_[plane] = used_++;
      octets_[open_[plane]].clear(plane);
    }
    octets_[open_[plane]].add(p);
  }
  for (int o = 0; o < used_; ++o) {
    Octet& octet = octets_[o];
    octet.fetch(step.x0, octet.x0);
    octet.fetch(before, octet.before);
    octet.fetch(step.spring, octet.force);
    octet.add_from(step.force, octet.force);
    octet.fetch(x1, octet.x1);
    octet.fetch(v, octet.v);
    octet.fetch(step.body.mass.data(), octet.mass);
    octet.fetch(step.body.damping.data(), octet.damping);
    octet.fetch(step.kicks.opening_mass().data(), octet.inertia);
  }
  return true;
}

void Contact::hold(const Points& v) {
  for (int o = 0; o < used_; ++o) octets_[o].fetch(v, octets_[o].unkicked);
}

template <class Wanted>
unsigned Contact::lanes_where(const Octet& octet, Wanted wanted) const {
  unsigned lanes = octet.all();
  for (std::size_t q = 0; q < end_.size(); ++q) {
    Octet::Number gaps;
    gaps_of(end_[q], octet, gaps);
    for (int lane = 0; lane < octet.count; ++lane)
      if (!wanted(int(q), gaps[lane])) lanes &= ~(1u << lane);
  }
  return lanes;
}

void Contact::book(const Octet& octet, unsigned lanes, Impulse& plane) {
  Impulse sum = plane;
  for (int lane = 0; lane < octet.count; ++lane) {
    if (!(lanes >> lane & 1)) continue;
    sum.force -= lane_of(octet.impulse, lane);
    sum.torque += lane_of(octet.torque, lane);
  }
  plane = sum;
}

void Contact::book(Octet& octet, int lane, int plane, const Vec3& impulse, const Vec3& x1, Exchange& exchange) const {
  exchange.planes[plane].add(-impulse, x1 - end_[plane].point);
  set_lane(octet.received, lane, lane_of(octet.received, lane) + impulse);
  octet.work[lane] += impulse.dot(end_[plane].material_velocity(x1));
}

int Contact::deepest(const Vec3& x1) const {
  int deepest = 0;
  for (std::size_t q = 1; q < end_.size(); ++q)
    if (end_[q].gap(x1) < end_[deepest].gap(x1)) deepest = int(q);
  return deepest;
}

StepStatus Contact::several_contacts(const StepView& step, Octet& octet, int lane, Vec3& x1, Vec3& v, Exchange& exchange) {
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
    book(octet, lane, int(q), octet.inertia[lane] * (c.normal_impulse * c.normal + c.friction_impulse), x1, exchange);
  }
  return StepStatus::ok;
}

StepStatus Contact::close(const StepView& step, Points& v, Exchange& exchange) {
  const double contact = touching * step.body.length;
  for (int o = 0; o < used_; ++o) {
    Octet& octet = octets_[o];
    octet.fetch(v, octet.v);
    octet.add_from(step.spring, octet.force);
    octet.add_from(step.force, octet.force);
    for (Octet::Number& forces : octet.force)
      for (double& force : forces) force *= 0.5;
    octet.fetch(step.kicks.closing_mass().data(), octet.inertia);
    const Approach& plane = approach_[octet.plane];
    Octet::Number lost;
    const unsigned alone = lanes_where(octet, [&](int q, double gap) { return q == octet.plane ? gap <= contact : gap > contact; });
    if (alone != octet.all()) unsettled_ = octet;
    settle(plane, octet);
    book(octet, alone, exchange.planes[octet.plane]);
    for (int lane = 0; lane < octet.count; ++lane) {
      if (alone >> lane & 1) continue;
      const StepStatus status = close_lane(step, octet, lane, exchange);
      if (status != StepStatus::ok) return status;
    }
    weigh(step.h, octet, lost);
    octet.put(octet.v, v);
    exchange.work = std::accumulate(octet.work, octet.work + octet.count, exchange.work);
    exchange.dissipated = std::accumulate(lost, lost + octet.count, exchange.dissipated);
    exchange.contacts_resolved += octet.count;
  }
  return StepStatus::ok;
}

StepStatus Contact::close_lane(const StepView& step, Octet& octet, int lane, Exchange& exchange) {
  const Vec3 x1 = lane_of(octet.x1, lane);
  active_.clear();
  for (std::size_t q = 0; q < end_.size(); ++q)
    if (end_[q].gap(x1) <= touching * step.body.length) active_.push_back(int(q));
  if (active_.size() == 1) {
    Octet other = unsettled_;
    settle(approach_[active_[0]], other);
    octet.take(lane, other);
    book(octet, 1u << lane, exchange.planes[active_[0]]);
    return StepStatus::ok;
  }
  octet.take(lane, unsettled_);
  if (active_.empty()) return StepStatus::ok;
  constraints_.clear();
  for (const int q : active_) {
    const Vec3 surface = end_[q].material_velocity(x1);
    const Vec3& n = end_[q].normal;
    constraints_.push_back({.normal = n, .bound = n.dot(surface), .friction = approach_[q].friction, .surface = surface});
  }
  Vec3 v = lane_of(octet.v, lane);
  if (!feasible_.resolve(constraints_, velocity_slack * (unit_speed + v.norm()), v)) return StepStatus::impossible_planes;
  set_lane(octet.v, lane, v);
  for (std::size_t i = 0; i < active_.size(); ++i) {
    const Constraint& c = constraints_[i];
    book(octet, lane, active_[i], octet.inertia[lane] * (c.normal_impulse * c.normal + c.friction_impulse), x1, exchange);
  }
  return StepStatus::ok;
}

Count points_on(const HalfSpace& obstacle, double length, const Points& x) {
  Count count = 0;
  for (int p = 0; p < x.rows(); ++p) count += obstacle.gap(row(x, p)) <= touching * length;
  return count;
}

}  // namespace softffd
