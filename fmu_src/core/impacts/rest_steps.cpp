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

// Steps are the largest stable explicit ones; kit/thresholds.hpp says what the values rest on.

/// Largest energy that the first implicit step may lose, in units of `allowed_loss` [1]; fraction of the tolerance for its error [1].
constexpr double settling_loss = 3, settling_fraction = 0.5;
/// Implicit steps pay from this length on, in explicit steps: the three implicit steps of a step doubling cost as much.
constexpr double worth_resting = 400;
/// Fraction of the tolerance for the error of a step at rest: at most, and per fraction of the run that the step takes [1]. If the error
/// is below `easy_rest` of the allowed one, the next steps are run once, at most `longest_rest_trust` of them.
constexpr double rest_fraction = 0.5, rest_rate = 4, easy_rest = 0.2;
constexpr Count longest_rest_trust = 128;
/// Fraction of that error that a contact event within the step may cause [1]; above it, the step ends at the event. `event_shrink`: the
/// fraction of a step that is tried first if the time of the event is unknown, and the largest fraction by which a step stops short of the
/// event [1]. `most_event_tries`: the largest number of tries for the time of the event.
constexpr double event_fraction = 0.1, event_shrink = 0.125;
constexpr int most_event_tries = 12;
/// A body at rest with a larger gap has lifted off; a smaller gap is closed after a rigid shift of the body. Gaps relative to the box [1].
constexpr double lifted = 1e-9, snapped = 1e-13;

}  // namespace thresholds

namespace {

namespace use = thresholds;

/// Returns the acceleration of the nearest obstacle [m/s2]; zero if pins hold the body or there are free bodies.
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
  if (std::ranges::any_of(context.drive.free, &FreeMotion::loads_grow)) {  // the time at which friction gives way is not looked for
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

/// True if steps of h [s] do not pay. Then the windows go on, and observe the body for longer before the next rest.
bool RestSteps::doubted(const Beside& at, double h) {
  StiffContact& stiff = at.context.run.physical.stiff;
  if (h >= use::worth_resting * at.limit) return false;
  const Count doubts = std::min(stiff.doubts + 1, use::most_doubts);
  stiff.begin(Phase::contact);
  stiff.doubts = doubts;
  return true;
}

/// Takes the first step at rest, which removes the remaining velocities, with h and with two of h / 2. Windows go on if a contact's state
/// changes within the step or if the two results differ: a body that turns is not at rest.
StepStatus RestSteps::settle(const Beside& at) {
  const StepContext& context = at.context;
  PhysicalState& physical = context.run.physical;
  StiffContact& stiff = physical.stiff;
  const double time = physical.motion.time, h = std::min(at.end - time, use::settling_steps * at.limit);
  const double end = h < at.end - time ? time + h : at.end, most = use::event_fraction * allowed(context, h);
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
      if (left.size <= use::settling_fraction * context.request.tolerance) {
        physical.error.add(left);
        stiff.settling = false;
        lose(context, h, lost);
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

/// Adds the energy lost in a step of h [s] to what vibrations would still have of that lost before. Pins hold a body without obstacles,
/// too.
void RestSteps::lose(const StepContext& context, double h, double lost) {
  if (!context.drive.pins.empty()) return;
  double& damped = context.run.physical.stiff.damped;
  damped = damped * std::max(0.0, 1 - h / vibration_lasts(context)) + std::max(0.0, lost);
}

/// True if the body tips over its obstacle: then no step resembles the one before.
bool RestSteps::tips(const StepContext& context) const {
  if (!context.drive.pins.empty()) return false;
  const State& motion = context.run.physical.motion;
  const HalfSpace obstacle = nearest_obstacle(context, motion).obstacle;
  const RigidMotion rigid = rigid_motion(context.model.body.mass, motion.x, motion.v);
  const double speed = radius_about(rigid.centre, motion.x) * tangential(obstacle.normal, rigid.spin - obstacle.spin).norm();
  return speed * left_of_run(context) > use::rest_fraction * context.request.tolerance;
}

/// Returns the largest final error that a step of h [s] may have [m].
double RestSteps::allowed(const StepContext& context, double h) const {
  const double tolerance = context.request.tolerance * power(context.request.step_factor, 2);
  return std::min(use::rest_fraction, use::rest_rate * h / left_of_run(context)) * tolerance;
}

/// Takes one step to the end. If energy is lost, a contact's state changes or the body tips, returns false and ends all trust.
bool RestSteps::step_once(const Beside& at) {
  PhysicalState& physical = at.context.run.physical;
  StiffContact& stiff = physical.stiff;
  {
    const double most = use::event_fraction * allowed(at.context, at.end - physical.motion.time);
    Snapshot snapshot(physical, start_);
    const Step taken = step(at, at.end);
    const bool steady =
        taken.status == StepStatus::ok && !tips(at.context) && event_of(at.context, taken.slip, taken.pressing, start_, most).error <= most;
    if (steady && std::abs(taken.lost) < allowed_loss(at.context, taken.pressing)) {
      --stiff.rest_trust;
      stiff.pressing = taken.pressing;
      lose(at.context, physical.clock.h, taken.lost);
      snapshot.commit();
      return true;
    }
  }
  stiff.rest_trust = 0;
  stiff.next_rest_trust = 1;
  return false;
}

/// Takes the first step, cut at a contact event whose error exceeds `allowed` [m]. `next` becomes its end, from where the run goes on.
RestSteps::Step RestSteps::step_before_event(const Beside& at, double& next, double allowed, ContactEvent& event) {
  PhysicalState& physical = at.context.run.physical;
  const double time = physical.motion.time, whole = next - time;
  double length = whole, free = 0;  // free: a length without an event [s]
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
  Step taken = step_before_event(at, next, use::event_fraction * allowed(context, next - time), event);
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
    if (easy) std::swap(physical, coarse_);  // the step size of the trusted steps: another one would disturb a body at rest
    if (h >= use::worth_resting * at.limit) stiff.doubts = 0;
    if (easy) left = left.times(2);
    left.size += event.error;
    physical.error.add(left);
    stiff.pressing = taken.pressing;
    lose(context, h, lost);
    const double longer = h * std::clamp(factor, use::next_shrink, use::rest_growth);
    if (!cut) stiff.step = factor < 1 ? longer : std::max(stiff.step, longer);  // the call may have ended before the wanted step
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

/// Takes a backward Euler step, with the rigid motion by the mean velocity. settling: the mean velocity counts only along the obstacles.
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
  const bool along = settling || context.model.body.samples;  // no mean turn if the body rings or rolls over its samples
  follow_mean_velocity(context, before_, h, along);
  if (!along && !keep_in_front(context)) taken.status = StepStatus::not_finite;
  context.model.body.internal_force(physical.motion.x, physical.motion.spring);
  taken.lost = energy_lost(context, from, outcome.given);
  if (context.drive.watch) book_energies(context, from, x_, before_.exchange);
  return taken;
}

/// Takes a step as an observer sees it who has this acceleration since the beginning of the drive. Beside an obstacle with this
/// acceleration, all that sticks keeps its speed, as backward Euler assumes. The work of obstacles is given as seen from outside.
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

/// Shifts the whole body back onto the obstacles that it touched before the rigid motion was changed, and out of those that the change
/// moved it behind. Returns false if a point stays behind an obstacle.
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
