#include "impacts/windows.hpp"

#include <algorithm>
#include <cmath>

#include "contact/tolerances.hpp"
#include "kit/snapshot.hpp"
#include "kit/thresholds.hpp"
#include "model/arithmetic.hpp"
#include "watch/vibration.hpp"

namespace softffd {

namespace thresholds {

// Steps are the largest stable explicit ones; kit/thresholds.hpp says what the values rest on.

/// Steps between two looks at the body; largest number of looks in a window; least number of looks before the body can count as quiet.
constexpr double look_steps = 24, longest_window = 64;
constexpr Count least_looks = 4;
/// A window ends in a flight if nothing can be touched for this many steps.
constexpr double worth_flying = 40;
/// An impact is run with half the step for this many steps: a contact takes 48 to 120 steps whatever the stiffness.
constexpr double impact_length = 240;
/// Step of windows that are run once and have flights before and after, in largest stable steps [1]. Leapfrog keeps another energy than
/// the modes do, so that each change between them multiplies a vibration's energy by (2 - a)^2 / (4 (1 - a)) on average, with a =
/// (omega h / 2)^2: by 1.10 for the fastest vibration at the largest step, by 1.0002 at a quarter of that step.
constexpr double after_flight = 0.25;
/// If the error by lost phases of the vibrations exceeds `hopeless` tolerances, impacts may add `share_of_known` of that error, because
/// nothing can keep the tolerance then. If the total error exceeds `lost` tolerances, windows are run once.
constexpr double hopeless = 10, fraction_of_known = 0.1, lost = 300;
/// Smallest step of a window, in largest stable steps; largest number of reruns of a window.
constexpr double finest_window = 1.0 / 64;
constexpr int most_window_tries = 6;
/// If the error of the coarser run is below this fraction of the allowed error, the next windows are run once with the same step; at most
/// `longest_window_trust` of them. The rule holds only in contact that goes on: for a body that had not touched yet, it would make the
/// impact a single unchecked run.
constexpr double easy = 0.4;
constexpr Count longest_window_trust = 32;
/// Fraction of the tolerance by which vibrations are taken to err if they flew by their modes and the contact before was run once.
/// Measured: a tenth of the tolerance reports three times the true error, a thousandth at times reports a third of it.
constexpr double flown_error = 0.01;
/// Energy that may be damped away, relative to the work of the pressing force along the tolerance [1]: it cannot move the body further.
constexpr double quiet_energy = 0.1;

}  // namespace thresholds

namespace {

namespace use = thresholds;

/// Returns how large the vibrations are: their kinetic energy plus that of free bodies relative to the object [J]. For a pinned body,
/// which no force has to press on an obstacle, returns their size [m].
double loudness(const StepContext& context) {
  const State& motion = context.run.physical.motion;
  if (context.drive.pins.empty()) {
    double energy = kinetic_deformation(context.model.body, motion);
    if (context.drive.free.empty()) return energy;
    const RigidMotion rigid = rigid_motion(context.model.body.mass, motion.x, motion.v);
    for (const FreeMotion& each : context.drive.free) {
      FreeState beside = motion.free[each.index()];
      const Vec3 spin = each.spin(beside) - rigid.spin;
      beside.velocity -= rigid.velocity + rigid.spin.cross(beside.position - rigid.centre);
      beside.momentum = each.momentum(beside, spin);
      energy += each.kinetic_energy(beside);
    }
    return energy;
  }
  return present_vibration(context.equations(), motion, context.model.time_scale, infinity);
}

/// Returns the least force that presses the object on obstacles, or a free body on what holds it [N]; 0 if loads grow.
double least_pressing(const StepContext& context) {
  const StiffContact& stiff = context.run.physical.stiff;
  double least = stiff.impulse / stiff.listened;
  for (const FreeMotion& each : context.drive.free) {
    const Vec3 force = each.loads(context.run.physical.motion.free[each.index()]).force;
    const double along = each.body().guided() ? std::abs(each.body().guide.dot(force)) : force.norm();
    least = each.loads_grow() ? 0 : std::min(least, along);
  }
  return least;
}

/// True if the vibrations cannot move the body by an amount that matters, against the force that pressed on it while it was observed.
bool quiet(const StepContext& context) {
  const StiffContact& stiff = context.run.physical.stiff;
  if (!context.drive.pins.empty()) return stiff.loudest <= use::quiet * context.request.tolerance;
  const double pressing = least_pressing(context);
  return pressing > 0 && 2 * stiff.loudest <= allowed_loss(context, pressing);
}

}  // namespace

double allowed_loss(const StepContext& context, double pressing) {
  return context.drive.pins.empty() ? use::quiet_energy * pressing * context.request.tolerance : infinity;
}

StepStatus Windows::run(const Beside& at, Flights& flights) {
  const StepContext& context = at.context;
  PhysicalState& physical = context.run.physical;
  ControllerState& control = context.run.control;
  StiffContact& stiff = physical.stiff;
  const double tolerance = context.request.tolerance * power(context.request.step_factor, 2);
  const double begun = physical.motion.time, until = std::min(at.end, begun + use::longest_window * use::look_steps * at.limit);
  const bool fresh = stiff.phase == Phase::impact;
  const Phase after = fresh && begun - stiff.since < use::impact_length * at.limit ? Phase::impact : Phase::contact;
  const double least = use::finest_window * at.limit;
  control.method = Method::leapfrog;
  control.reason = Reason::impact;
  stiff.phase = after;
  const bool touches = !off_obstacles(context, touching), lost = physical.total_error() > use::lost * tolerance,
             flown = context.drive.pins.empty() && flights.has_modes(context.model.body);
  if (lost || (!fresh && stiff.trust > 0 && touches)) {
    if (!lost) --stiff.trust;
    start_ = physical;
    stiff.flown = 0;
    const double h = lost && flown ? use::after_flight * at.limit : at.limit;
    const StepStatus status = listen(at, flights, h, until, true);
    stiff.settling = stiff.phase == Phase::rest;
    if (status == StepStatus::ok && !follow(at) && !lost) physical.error.add(stiff.trusted);
    return status;
  }
  Snapshot snapshot(physical, start_);
  double h = fresh ? 0.5 * at.limit : at.limit;
  StepStatus status = listen(at, flights, h, until, true);
  for (int tries = 0;; ++tries) {
    if (status != StepStatus::ok) return status;
    const Phase next = physical.stiff.phase;
    const double reached = physical.motion.time;
    std::swap(coarse_, physical);
    const bool rings = (fresh || next == Phase::flight) && context.drive.pins.empty() && flights.has_modes(context.model.body);
    snapshot.rollback();
    const Count taken = physical.steps;
    status = listen(at, flights, 0.5 * h, reached, false);
    if (status != StepStatus::ok) return status;
    const Outlook ahead = outlook(context, physical.motion);
    FinalError left = final_error(context, coarse_.motion, physical.motion, ahead).times(1.0 / 3);
    const Flights::PhaseError phase = rings ? flights.phase_error(at, coarse_.motion, ahead) : Flights::PhaseError();
    left.size = std::max(left.size, phase.at_impact);
    const double error = left.size;
    const double exact = use::window_fraction * tolerance / (1 + phase.gain);
    const double known = fresh && stiff.unknown > use::hopeless * tolerance ? use::fraction_of_known * stiff.unknown : 0;
    const double allowed = std::max(physical.total_error() > exact ? use::window_fraction * tolerance : exact, known);
    const bool last = 0.5 * h <= least || tries == use::most_window_tries;
    if (last && !std::isfinite(error)) return StepStatus::not_finite;
    if (error <= allowed || last) {
      const bool easy = touches && !fresh && tries == 0 && 4 * error < use::easy * allowed;
      if (easy) std::swap(physical, coarse_);  // the step size of the trusted windows: another one would disturb a body at rest
      stiff.trusted.learn(left.times(4));
      stiff.phase = next;
      stiff.settling = next == Phase::rest;
      stiff.trust = easy ? stiff.next_trust : 0;
      stiff.next_trust = easy ? std::min(2 * stiff.next_trust, use::longest_window_trust) : 1;
      stiff.flown = (easy ? 1 : 1.0 / 3) * phase.apart;
      snapshot.commit();
      if (!follow(at)) physical.error.add(easy ? left.times(4) : left);
      return StepStatus::ok;
    }
    control.rejected += physical.steps - taken;
    const double ratio = std::isfinite(error) ? allowed / error : 0,
                 factor = std::clamp(use::window_safety * std::sqrt(ratio), use::window_shrink, 0.5);
    const double smaller = std::max(h * factor, std::min(0.5 * h, 2 * least));
    if (smaller == 0.5 * h) {  // the finer run is the next coarse one
      physical.stiff.phase = next;
    } else {
      snapshot.rollback();
      status = listen(at, flights, smaller, until, true);
    }
    h = smaller;
  }
}

/// Returns the error of the vibrations when the window began, by the last window that was run twice [m]; else by `flown_error`.
double Windows::flown(const StepContext& context) const {
  return start_.stiff.flown > 0 ? start_.stiff.flown : use::flown_error * context.request.tolerance;
}

/// Lets the neighbour trajectory follow, which shows how the window amplifies errors. A flight waits until the neighbour is off the
/// obstacles too, for at most a period of the slowest vibration; if the body rests, the neighbour rests too. Returns true if the
/// amplification is known.
bool Windows::follow(const Beside& at) {
  const StepContext& context = at.context;
  const PhysicalState& physical = context.run.physical;
  const Neighbour& neighbour = context.run.control.neighbour;
  const double begun = start_.motion.time, length = physical.motion.time - begun;
  const Count steps = divisions(length, Landings::lands(context, begun, impacts_ > 0) ? at.limit : physical.clock.h);  // cut at a landing
  landings_.follow(at.integrators, context, start_.motion, Method::leapfrog, {begun, 0, length / double(steps), steps}, impacts_ > 0,
                   start_.stiff.phase == Phase::impact ? flown(context) : 0);
  if (neighbour.off.time != physical.motion.time) return false;
  if (!neighbour.follows) return true;
  StiffContact& stiff = context.run.physical.stiff;
  const bool flies = stiff.phase == Phase::flight;
  if (flies && physical.motion.time - neighbour.began <= slowest_period(context))
    stiff.phase = Phase::contact;
  else if (flies || stiff.phase == Phase::rest)
    landings_.part(context, flies);
  return true;
}

/// Takes explicit steps of h [s] until `until` [s], or, if `decide`, until the phase changes. Looks come at the same times whatever h is.
StepStatus Windows::listen(const Beside& at, Flights& flights, double h, double until, bool decide) {
  const StepContext& context = at.context;
  PhysicalState& physical = context.run.physical;
  State& motion = physical.motion;
  StiffContact& stiff = physical.stiff;
  const double stretch = use::look_steps * at.limit;
  bool quiet_now = false;
  impacts_ = 0;
  for (double begun = motion.time; motion.time < until; begun = motion.time) {
    const bool last = until - begun <= stretch * (1 + 1e-9);
    const double length = last ? until - begun : stretch;
    const Count steps = divisions(length, h), quarter = std::max(Count{1}, steps / 4);
    physical.clock = {begun, length / double(steps), 0};
    pushed_ = physical.exchange.planes;
    const Count contacts = physical.exchange.contacts_resolved;
    for (Count i = 0; i < steps; i += quarter) {
      const Span span{begun, i, physical.clock.h, std::min(quarter, steps - i)};
      const Outcome outcome = at.integrators.take(context, Method::leapfrog, span);
      context.run.control.work += outcome.work;
      impacts_ += outcome.impacts;
      physical.steps += span.steps;
      if (outcome.status != StepStatus::ok) return outcome.status;
      motion.time = i + quarter >= steps ? (last ? until : begun + length) : span.time(span.steps);
      stiff.loudest = std::max(stiff.loudest, loudness(context));
    }
    stiff.impulse += pressed_since(context, pushed_);
    stiff.listened += length;
    ++stiff.looks;
    const bool touched = physical.exchange.contacts_resolved != contacts;
    const double period = slowest_period(context);
    const bool heard = double(stiff.looks) >= std::max(double(use::least_looks << stiff.doubts), period / stretch);
    const bool rests = heard && (touched || !context.drive.pins.empty()) && quiet(context);
    if (heard) {
      stiff.pressing = stiff.impulse / stiff.listened;
      stiff.looks = 0;
      stiff.impulse = stiff.listened = stiff.loudest = 0;
    }
    if (!decide) continue;
    quiet_now = quiet_now || rests;
    // The first step at rest removes the remaining velocities; a much shorter step does not.
    const bool room = at.end - motion.time >= 0.5 * use::settling_steps * at.limit;
    if (quiet_now && (room || motion.time >= at.end)) {
      stiff.phase = Phase::rest;
      return StepStatus::ok;
    }
    if (motion.time >= until) continue;
    if (!touched && off_obstacles(context, touching) && flights.can_fly(at, use::worth_flying * at.limit, until)) {
      stiff.phase = Phase::flight;
      return StepStatus::ok;
    }
  }
  return StepStatus::ok;
}

}  // namespace softffd
