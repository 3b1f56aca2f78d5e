#include "impacts/rest_steps.hpp"

#include <algorithm>
#include <cmath>

#include "contact/feasible.hpp"
#include "contact/tolerances.hpp"
#include "impacts/contact_events.hpp"
#include "impacts/mean_velocity.hpp"
#include "impacts/windows.hpp"
#include "kit/snapshot.hpp"
#include "kit/thresholds.hpp"
#include "model/arithmetic.hpp"

namespace softffd {

namespace thresholds {

// Steps are the largest stable explicit ones; what these rest on stands in kit/thresholds.hpp.

/// Energy that the first implicit step may lose, in that of the pressing force along the tolerance [1]; part of the tolerance for its
/// error.
constexpr double settling_loss = 3, settling_share = 0.5;
/// Steps from which on implicit ones pay: three cost what these do.
constexpr double worth_resting = 400;
/// Part of the tolerance for the error of a step at rest, at most and per share of the run that it takes [1]; what lets the next be taken
/// once, and how many of these at most.
constexpr double rest_share = 0.5, rest_rate = 4, easy_rest = 0.2;
constexpr Count longest_rest_trust = 128;
/// Of that error, what an event of a contact within the step may leave: beyond, the step ends at the event. What is tried for its time at
/// most, and the part of a step that is tried first where nothing tells when it is; a step also stops short of it by this part at most [1].
constexpr double event_share = 0.1, event_shrink = 0.125;
constexpr int most_event_tries = 12;
/// Gap relative to the box at which a body at rest has lifted off; gap that is closed after the body is moved as a whole [1].
constexpr double lifted = 1e-9, snapped = 1e-13;

}  // namespace thresholds

namespace {

namespace use = thresholds;

/// Acceleration of the obstacle next to a body that no pin holds, nor a free body rests on [m/s2].
Vec3 obstacle_acceleration(const StepContext& context, const State& state) {
  const auto& planes = context.drive.planes;
  const bool steady = std::all_of(planes.begin(), planes.end(), [](const Plane& plane) { return plane.acceleration.isZero(0); });
  return steady || !context.drive.pins.empty() || !context.drive.free.empty() ? Vec3(Vec3::Zero())
                                                                              : nearest_obstacle(context, state).plane->acceleration;
}

}  // namespace

RestSteps::RestSteps(const Run& run) : start_(run.physical), before_(run.physical), coarse_(run.physical), x_(run.physical.motion.x) {
  drive_.planes.reserve(run.physical.exchange.planes.size());
  obstacles_.reserve(run.physical.exchange.planes.size());
}

StepStatus RestSteps::run(const Beside& at) {
  const StepContext& context = at.context;
  StiffContact& stiff = context.run.physical.stiff;
  context.run.control.method = Method::backward_euler;
  context.run.control.reason = Reason::stiff_contact;
  context.run.energy.kinetic_elastic = -1;
  if (context.drive.pins.empty() && off_obstacles(context, use::lifted)) {
    stiff.begin(Phase::flight);
    return StepStatus::ok;
  }
  if (std::ranges::any_of(context.drive.free, &FreeMotion::loads_grow)) {  // when friction gives way is not looked for
    stiff.begin(Phase::contact);
    return StepStatus::ok;
  }
  if (stiff.settling) return settle(at);
  const double time = context.run.physical.motion.time, left = at.end - time;
  const double wanted = stiff.step > 0 ? std::min(stiff.step, left) : left;
  if (wanted < left && doubted(at, wanted)) return StepStatus::ok;
  const Count parts = divisions(left, wanted);
  const double next = parts == 1 ? at.end : time + left / double(parts);
  if (parts == 1 && stiff.rest_trust > 0 && step_once(at)) return StepStatus::ok;
  return step_twice(at, next);
}

/// Whether steps of h do not pay: back to windows, to listen for longer.
bool RestSteps::doubted(const Beside& at, double h) {
  StiffContact& stiff = at.context.run.physical.stiff;
  if (h >= use::worth_resting * at.limit) return false;
  const Count doubts = std::min(stiff.doubts + 1, use::most_doubts);
  stiff.begin(Phase::contact);
  stiff.doubts = doubts;
  return true;
}

/// The first step takes up what velocities are left; with h and with two of h / 2. Windows go on where a contact's state changes within it,
/// or where the two differ: a body that turns is not at rest.
StepStatus RestSteps::settle(const Beside& at) {
  const StepContext& context = at.context;
  PhysicalState& physical = context.run.physical;
  StiffContact& stiff = physical.stiff;
  const double time = physical.motion.time, h = std::min(at.end - time, use::settling_steps * at.limit);
  const double end = h < at.end - time ? time + h : at.end, most = use::event_share * allowed(context, h);
  Snapshot snapshot(physical, start_);
  Step taken = step(at, end, true);
  const bool steady = taken.status == StepStatus::ok && event_of(context, taken.slip, taken.pressing, start_, most).error <= most;
  if (steady) {
    std::swap(coarse_, physical);
    snapshot.rollback();
    double lost = 0;
    for (const double until : {time + 0.5 * h, end}) {
      if (taken.status == StepStatus::ok) taken = step(at, until, true);
      lost += taken.lost;
    }
    if (taken.status == StepStatus::ok && lost <= use::settling_loss * allowed_loss(context, stiff.pressing)) {
      const FinalError left = final_error(context, coarse_.motion, physical.motion, outlook_of_stiff(context, physical.motion));
      if (left.size <= use::settling_share * context.request.tolerance) {
        physical.error.add(left);
        stiff.settling = false;
        stiff.step = use::rest_growth * h;
        snapshot.commit();
        return StepStatus::ok;
      }
    }
  }
  snapshot.rollback();
  snapshot.commit();
  if (taken.status == StepStatus::ok && !steady)
    stiff.begin(Phase::contact);
  else
    doubted(at, 0);
  return StepStatus::ok;
}

/// Whether the body turns over its obstacle: no step of that is like the one before.
bool RestSteps::tips(const StepContext& context) const {
  if (!context.drive.pins.empty()) return false;
  const State& motion = context.run.physical.motion;
  const HalfSpace obstacle = nearest_obstacle(context, motion).obstacle;
  const RigidMotion rigid = rigid_motion(context.model.body.mass, motion.x, motion.v);
  const double speed = radius_about(rigid.centre, motion.x) * tangential(obstacle.normal, rigid.spin - obstacle.spin).norm();
  return speed * left_of_run(context) > use::rest_share * context.request.tolerance;
}

/// Error of a step of h that may be left at the end of the run [m].
double RestSteps::allowed(const StepContext& context, double h) const {
  const double tolerance = context.request.tolerance * power(context.request.step_factor, 2);
  return std::min(use::rest_share, use::rest_rate * h / left_of_run(context)) * tolerance;
}

/// To the end, unless energy is lost or a contact's state changes: then nothing is trusted any more.
bool RestSteps::step_once(const Beside& at) {
  PhysicalState& physical = at.context.run.physical;
  StiffContact& stiff = physical.stiff;
  {
    const double most = use::event_share * allowed(at.context, at.end - physical.motion.time);
    Snapshot snapshot(physical, start_);
    const Step taken = step(at, at.end);
    const bool steady =
        taken.status == StepStatus::ok && !tips(at.context) && event_of(at.context, taken.slip, taken.pressing, start_, most).error <= most;
    if (steady && std::abs(taken.lost) < allowed_loss(at.context, taken.pressing)) {
      --stiff.rest_trust;
      stiff.pressing = taken.pressing;
      snapshot.commit();
      return true;
    }
  }
  stiff.rest_trust = 0;
  stiff.next_rest_trust = 1;
  return false;
}

/// The first step, no longer than to where an event lies that matters: next becomes its end. The run goes on from there.
RestSteps::Step RestSteps::step_before_event(const Beside& at, double& next, double allowed, ContactEvent& event) {
  PhysicalState& physical = at.context.run.physical;
  const double time = physical.motion.time, whole = next - time;
  double length = whole, free = 0;  // free: without an event
  for (int tries = 0;; ++tries) {
    next = length == whole ? next : time + length;
    const Step taken = step(at, next);
    if (taken.status != StepStatus::ok) return taken;
    event = event_of(at.context, taken.slip, taken.pressing, start_, allowed);
    const bool last = length == free || tries == use::most_event_tries || length <= at.limit;
    if (event.error > allowed && !last) {
      const double shorter = event.at > 0 ? std::clamp(event.at, length * use::event_shrink, 0.9 * length) : length * use::event_shrink;
      length = free > 0 ? free : shorter;
    } else {
      const Slip& slip = taken.slip;
      const double slows = slip.before - slip.along;
      if (last || length == whole || free > 0 || !(slows > 0)) return taken;
      const double before = slip.before / slip.load * std::max(outlook_of_stiff(at.context, physical.motion).along_plane, whole);
      const double short_of = std::min(use::event_shrink, allowed / (2 * before));
      const double longer = std::min(length * slip.before / slows * (1 - short_of), whole);
      if (!(longer > 2 * length)) return taken;
      free = length;
      length = longer;
    }
    assign(physical, start_);
  }
}

StepStatus RestSteps::step_twice(const Beside& at, double next) {
  const StepContext& context = at.context;
  PhysicalState& physical = context.run.physical;
  StiffContact& stiff = physical.stiff;
  const double time = physical.motion.time, wanted = next;
  Snapshot snapshot(physical, start_);
  ContactEvent event;
  Step taken = step_before_event(at, next, use::event_share * allowed(context, next - time), event);
  const double h = next - time;
  const bool cut = next != wanted;
  FinalError left{infinity};
  double lost = 0;
  if (taken.status == StepStatus::ok) {
    std::swap(coarse_, physical);
    snapshot.rollback();
    for (const double until : {time + 0.5 * h, next}) {
      if (taken.status == StepStatus::ok) taken = step(at, until);
      lost += taken.lost;
    }
    if (taken.status == StepStatus::ok)
      left = final_error(context, coarse_.motion, physical.motion, outlook_of_stiff(context, physical.motion));
  }
  const double error = left.size;
  const double most = allowed(context, h), factor = error > 0 ? use::window_safety * std::sqrt(most / error) : use::rest_growth;
  const bool quiet = std::abs(lost) < allowed_loss(context, taken.pressing);
  if (error <= most && quiet) {
    const bool easy = next == at.end && error < use::easy_rest * most;
    if (easy) std::swap(physical, coarse_);  // a step as those that are trusted: others would set off what is at rest
    if (h >= use::worth_resting * at.limit) stiff.doubts = 0;
    if (easy) left = left.times(2);
    left.size += event.error;
    physical.error.add(left);
    stiff.pressing = taken.pressing;
    const double longer = h * std::clamp(factor, use::next_shrink, use::rest_growth);
    if (!cut) stiff.step = factor < 1 ? longer : std::max(stiff.step, longer);  // the call may have ended before the step wanted
    stiff.rest_trust = easy ? stiff.next_rest_trust : 0;
    stiff.next_rest_trust = easy ? std::min(2 * stiff.next_rest_trust, use::longest_rest_trust) : 1;
    snapshot.commit();
    return StepStatus::ok;
  }
  context.run.control.rejected += 2;
  snapshot.rollback();
  snapshot.commit();
  stiff.step = h * std::clamp(std::isfinite(error) ? factor : 0, use::window_shrink, quiet ? 0.5 : use::loss_shrink);
  doubted(at, stiff.step);
  return StepStatus::ok;
}

/// A step of backward Euler, its rigid motion by the mean velocity. settling: along the obstacles alone.
RestSteps::Step RestSteps::step(const Beside& at, double until, bool settling) {
  const StepContext& context = at.context;
  PhysicalState& physical = context.run.physical;
  before_ = physical;
  const State& from = before_.motion;
  const double h = until - from.time;
  physical.clock = {from.time, h, 0};
  const double most = std::max(at.integrators.patience(), use::doubled_work * h / at.limit);
  const Span span{from.time, 0, h, 1, most};
  const Vec3 faster = obstacle_acceleration(context, from);
  const Outcome outcome = faster.isZero(0) ? at.integrators.take(context, Method::backward_euler, span) : take_in_frame(at, faster, span);
  context.run.control.work += outcome.work;
  Step taken{.status = outcome.status, .slip = outcome.slip};
  if (taken.status != StepStatus::ok) return taken;
  physical.motion.time = until;
  ++physical.steps;
  taken.pressing = pressed_since(context, before_.exchange.planes) / h;
  if (!context.drive.pins.empty()) return taken;
  x_ = physical.motion.x;
  const bool along = settling || context.model.body.samples;  // what rings, and a surface that rolls over its samples, has no mean turn
  follow_mean_velocity(context, before_, h, along);
  if (!along && !keep_in_front(context)) taken.status = StepStatus::not_finite;
  context.model.body.internal_force(physical.motion.x, physical.motion.spring);
  taken.lost = energy_lost(context, from, outcome.given);
  if (context.drive.watch) book_energies(context, from, x_, before_.exchange);
  return taken;
}

/// A step as an observer sees it who has this acceleration from the begin of the drive on: beside an obstacle that moves so, everything
/// keeps its speed while it sticks, as backward Euler takes it to. Work of obstacles is given as seen from outside.
Outcome RestSteps::take_in_frame(const Beside& at, const Vec3& acceleration, const Span& span) {
  const StepContext& context = at.context;
  PhysicalState& physical = context.run.physical;
  drive_ = context.drive;
  for (Plane& plane : drive_.planes) {
    const double age = drive_.since - plane.since;
    plane.point -= 0.5 * age * age * acceleration;
    plane.velocity += age * acceleration;
    plane.acceleration -= acceleration;
  }
  const auto see = [&](double sign, double time) {
    const double age = time - drive_.since;
    for (int axis = 0; axis < 3; ++axis) {
      physical.motion.x.col(axis) += sign * 0.5 * age * age * acceleration[axis];
      physical.motion.v.col(axis) += sign * age * acceleration[axis];
    }
  };
  for (int axis = 0; axis < 3; ++axis) drive_.force.col(axis) -= context.model.body.mass * acceleration[axis];
  see(-1, span.origin);
  Outcome outcome = at.integrators.take({context.model, drive_, context.request, context.run}, Method::backward_euler, span);
  see(1, span.origin + span.h);
  Vec3 impulse = Vec3::Zero();
  for (std::size_t q = 0; q < drive_.planes.size(); ++q) impulse -= physical.exchange.planes[q].force - before_.exchange.planes[q].force;
  const double more = (span.origin + 0.5 * span.h - drive_.since) * impulse.dot(acceleration);
  outcome.given += more;
  if (context.drive.watch) physical.exchange.work += more;
  if (context.drive.watch && context.drive.ramped) {
    const double age = span.origin - drive_.since, way = 0.5 * span.h * (2 * age + span.h);
    for (Eigen::Index i = 0; i < physical.motion.x.size(); ++i)
      physical.exchange.work += way * acceleration[i / physical.motion.x.rows()] * context.drive.ramp(i, span.origin + 0.5 * span.h);
  }
  return outcome;
}

/// Brings the body as a whole back onto the obstacles that it touched before it was moved, and off those that it was moved behind.
bool RestSteps::keep_in_front(const StepContext& context) {
  PhysicalState& physical = context.run.physical;
  State& motion = physical.motion;
  for (int round = 0; round < 3; ++round)
    for (std::size_t q = 0; q < context.drive.planes.size(); ++q) {
      const HalfSpace obstacle = context.drive.planes[q].at(motion.time);
      double least = infinity;
      for (int p = 0; p < motion.x.rows(); ++p) least = std::min(least, obstacle.gap(row(motion.x, p)));
      const bool touched = physical.exchange.planes[q].force != before_.exchange.planes[q].force;
      if (least < 0 || (touched && round == 0))
        for (int axis = 0; axis < 3; ++axis) motion.x.col(axis) -= least * obstacle.normal[axis];
    }
  obstacles_.clear();
  for (const Plane& plane : context.drive.planes) obstacles_.push_back(plane.at(motion.time));
  for (int p = 0; p < motion.x.rows(); ++p) {
    Vec3 here = row(motion.x, p);
    for (const HalfSpace& obstacle : obstacles_)
      if (std::abs(obstacle.gap(here)) < use::snapped * context.model.body.length) here -= obstacle.gap(here) * obstacle.normal;
    push_out(obstacles_, here);
    for (const HalfSpace& obstacle : obstacles_)
      if (obstacle.gap(here) < -position_slack * (context.model.body.length + here.norm())) return false;
    set_row(motion.x, p, here);
  }
  return true;
}

}  // namespace softffd
