#include "contact/contact.hpp"

#include <algorithm>
#include <bit>

#include "contact/tolerances.hpp"

namespace softffd {

namespace {

/// Number of bytes that hold one bit for each point.
constexpr int bytes(int points) { return (points + 7) / 8; }

/// Returns `sum` plus the numbers of these lanes, added one after the other.
double sum(const Octet::Number& of, unsigned lanes, double sum) {
  if (lanes == Octet::every) {
    for (const double each : of) sum += each;
    return sum;
  }
  for (unsigned left = lanes; left; left &= left - 1) sum += of[std::countr_zero(left)];
  return sum;
}

/// True if all points of the octet touch the octet's plane and no other plane.
bool alone(const Octet& octet) { return octet.alone == octet.all(); }

}  // namespace

Contact::Contact(int points, int planes)
    : start_(planes),
      end_(planes),
      approach_(planes),
      behind_(planes * bytes(points)),
      were_(behind_),
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

void Contact::begin(const Drive& around, double t0, double h) {
  at_hand_ = false;
  for (std::size_t q = 0; q < around.planes.size(); ++q) {
    const Plane& plane = around.planes[q];
    end_[q] = plane.at(t0);
    approach_[q] = {end_[q], end_[q], end_[q], plane.friction, h, plane.at_rest()};
  }
}

StepStatus Contact::drift(const StepView& step, const Points& before, Points& v, Points& x1, Exchange& exchange) {
  const bool at_hand = same_ && at_hand_;
  if (at_hand_ && !same_)
    for (int o = 0; o < used_; ++o) put(octets_[o], x1, v);
  at_hand_ = false;
  if (touched_.empty()) {
    used_ = 0;
    return StepStatus::ok;
  }
  for (std::size_t q = 0; q < step.around.planes.size(); ++q) {
    const Plane& plane = step.around.planes[q];
    if (!approach_[q].still) approach_[q] = {plane.at(step.t0), plane.at(0.5 * (step.t0 + step.t1)), end_[q], plane.friction, step.h};
  }
  if (!(same_ && grouped_ == step.body.version) && !group(step, x1)) return StepStatus::pin_behind_plane;
  if (!at_hand) gather(step, before, v, x1);
  for (int o = 0; o < used_; ++o)
    impacts_ += std::popcount(position_stage(approach_[octets_[o].plane], touching * step.body.length, octets_[o]));
  for (int o = 0; o < used_; ++o) {
    Octet& octet = octets_[o];
    if (end_.size() == 1)
      book(octet, octet.all(), exchange);
    else if (const StepStatus status = drift_lanes(step, v, x1, octet, exchange); status != StepStatus::ok)
      return status;
    put(octet, x1, v);
  }
  return StepStatus::ok;
}

/// Lists each point once. With several planes the points are not compared with those of the last drift.
void Contact::find(const StepView& step, const Points& x1) {
  const int n = step.body.points(), row = bytes(n);
  behind_.swap(were_);
  bool any = false;
  for (std::size_t q = 0; q < end_.size(); ++q) {
    if (!approach_[q].still) end_[q] = step.around.planes[q].at(step.t1);
    any = kernels::behind(n, x1.data(), end_[q].normal.data(), end_[q].offset, &behind_[q * row]) || any;
  }
  same_ = any && end_.size() == 1 && behind_ == were_;
  if (same_) return;
  touched_.clear();
  if (!any) return;
  for (std::size_t i = 0; i < behind_.size(); ++i)
    for (unsigned left = behind_[i]; left; left &= left - 1) {
      const int p = 8 * int(i % row) + std::countr_zero(left);
      if (!marked_[p]) marked_[p] = 1, touched_.push_back(p);
    }
  for (const int p : touched_) marked_[p] = 0;
}

/// Assigns the points found to octets, by plane. Returns false if a pinned point is too far behind a plane.
bool Contact::group(const StepView& step, const Points& x1) {
  used_ = 0;
  grouped_ = -1;
  std::fill(open_.begin(), open_.end(), -1);
  for (const int p : touched_) {
    const int plane = end_.size() == 1 ? 0 : deepest(row(x1, p));
    if (step.body.pinned[p]) {
      if (end_[plane].gap(row(x1, p)) < -pin_slack * step.body.length) return false;
      continue;
    }
    if (open_[plane] < 0 || octets_[open_[plane]].count == Octet::lanes) {
      open_[plane] = used_++;
      if (used_ > int(octets_.size())) octets_.emplace_back();
      octets_[open_[plane]].clear(plane);
    }
    octets_[open_[plane]].add(p);
  }
  grouped_ = step.body.version;
  return true;
}

void Contact::gather(const StepView& step, const Points& before, const Points& v, const Points& x1) {
  const HalfKicks& kicks = step.kicks;
  const Stage::Kick opening = kicks.stage(false).kicks[1];
  const Gathered all{step.body.mass.data(),
                     step.body.damping.data(),
                     kicks.opening_mass().data(),
                     kicks.closing_mass().data(),
                     opening.a,
                     opening.b,
                     step.x0,
                     before,
                     step.spring,
                     step.force,
                     x1,
                     v};
  for (int o = 0; o < used_; ++o) fetch(all, octets_[o]);
}

/// Books the impulses of these lanes on the octet's plane.
void Contact::book(const Octet& octet, unsigned lanes, Exchange& exchange) {
  Impulse& plane = exchange.planes[octet.plane];
  for (int c = 0; c < 3; ++c) {
    plane.force[c] = sum(octet.impulse[c], lanes, plane.force[c]);
    plane.torque[c] = sum(octet.torque[c], lanes, plane.torque[c]);
  }
  for (int lane = 0; lane < octet.count && !exchange.touched.empty(); ++lane)
    if (lanes >> lane & 1) exchange.touch(octet.plane, octet.point[lane], -lane_of(octet.impulse, lane));
}

int Contact::deepest(const Vec3& x1) const {
  int deepest = 0;
  for (std::size_t q = 1; q < end_.size(); ++q)
    if (end_[q].gap(x1) < end_[deepest].gap(x1)) deepest = int(q);
  return deepest;
}

StepStatus Contact::close(const StepView& step, Points& v, Exchange& exchange) {
  for (int o = 0; o < used_; ++o)
    if (Octet& octet = octets_[o]; alone(octet)) close_step(approach_[octet.plane], v, step.spring, step.force, octet);
  return book_close(step, v, exchange);
}

StepStatus Contact::close_and_go_on(const StepView& step, Points& v, Points& x1, Exchange& exchange) {
  for (int o = 0; o < used_; ++o)
    if (Octet& octet = octets_[o]; alone(octet)) close_and_open(approach_[octet.plane], v, step.spring, step.force, octet, x1);
  if (const StepStatus status = book_close(step, v, exchange); status != StepStatus::ok) return status;
  for (int o = 0; o < used_; ++o)
    if (Octet& octet = octets_[o]; !alone(octet)) open_step(step.h, octet, x1);
  at_hand_ = true;
  return StepStatus::ok;
}

/// Books impulses, work and losses of the closing correction. Octets with points that do not touch their plane alone are corrected here.
StepStatus Contact::book_close(const StepView& step, Points& v, Exchange& exchange) {
  for (int o = 0; o < used_; ++o) {
    Octet& octet = octets_[o];
    if (alone(octet))
      book(octet, octet.alone, exchange);
    else if (const StepStatus status = close_lanes(step, v, octet, exchange); status != StepStatus::ok)
      return status;
    exchange.work = sum(octet.work, octet.all(), exchange.work);
    exchange.dissipated = sum(octet.lost, octet.all(), exchange.dissipated);
    exchange.contacts_resolved += octet.count;
  }
  return StepStatus::ok;
}

Count points_on(const HalfSpace& obstacle, double length, const Points& x) {
  Count count = 0;
  for (int p = 0; p < x.rows(); ++p) count += obstacle.gap(row(x, p)) <= touching * length;
  return count;
}

}  // namespace softffd
