#include "impacts/flights.hpp"

#include <algorithm>
#include <cmath>

#include "contact/free/solid_samples.hpp"
#include "contact/tolerances.hpp"
#include "kit/thresholds.hpp"
#include "machine/elementary.hpp"
#include "model/arithmetic.hpp"

namespace softffd {

namespace thresholds {

// Steps are the largest stable explicit ones; kit/thresholds.hpp says what the values rest on.

/// Shortest flight in steps: if a touch is possible sooner, the body does not fly, because entering a flight costs as much.
constexpr double shortest_flight = 4;
/// An advance towards a possible touch that is shorter than this [steps] is the last one: further advances do not pay.
constexpr double shortest_advance = 0.25;
/// Work of decomposing a motion into modes, and work of a flight, in evaluations of the spring forces.
constexpr double entry_work = 15, flight_work = 30;
/// If the energy of the modes misses the body's own by more than this fraction, the body is far from its rest shape and does not fly [1].
constexpr double modal_mismatch = 0.01;
/// Fraction of the difference between the vibrations of two runs that the next rebound may feel [1].
constexpr double echo_fraction = 0.3;

}  // namespace thresholds

namespace {

namespace use = thresholds;

}  // namespace

bool Flights::rings_about_rest(const StepContext& context) {
  const State& motion = context.run.physical.motion;
  if (!context.drive.pins.empty() || !flight_.possible(context.model.body)) return false;
  context.run.control.work += use::entry_work;
  flight_.enter(context.equations(), motion.time, motion);
  const double left = left_of_run(context), drift = std::min(left, flight_.memory()) * flight_.neglected_rate();
  const double slight =
      use::window_fraction * context.request.tolerance / (use::rebound_fraction * left);  // speed that matters to no rebound
  const double missed = std::max(context.model.noise, 0.5 * flight_.modes().mass * slight * slight);
  const double left_out = std::max(drift, flight_.neglected_way(context.equations(), std::min(left, context.model.longest_lasting())));
  return left_out <= use::window_fraction * context.request.tolerance &&
         flight_.energy_missed() <= use::modal_mismatch * flight_.energy() + missed;
}

StepStatus Flights::fly(const Beside& at, bool rings) {
  const StepContext& context = at.context;
  PhysicalState& physical = context.run.physical;
  StiffContact& stiff = physical.stiff;
  State& motion = physical.motion;
  const double slight = touching * context.model.body.length;
  const std::vector<Plane>& planes = context.drive.planes;
  if (!off_obstacles(context, touching) || !free_off_others(planes, motion.time, slight) || !(rings || rings_about_rest(context))) {
    stiff.phase = Phase::contact;
    return StepStatus::ok;
  }
  before_ = physical;
  const double most = at.end - motion.time, begun = motion.time;
  const double mean = flight_.mean_frequency(), energy = flight_.energy(), neglected = flight_.neglected_rate();
  const double free = flight_.until_touch(context.equations(), most, use::shortest_advance * at.limit, false);
  bool touches = free < most;
  if (!(touches && free < use::shortest_flight * at.limit)) {
    flight_.leave(context.equations(), motion);
    const double landing = touches ? begun + free : at.end;
    for (const FreeMotion& each : context.drive.free) motion.free[each.index()] = each.flown(motion.free[each.index()], landing);
    motion.time = landing;
    context.run.control.work += use::flight_work;
    at.integrators.budget().spend(use::entry_work + use::flight_work);
    context.run.control.method = Method::floating_frame;
    context.run.control.reason = Reason::ringing_flight;
    physical.clock = {begun, free, 0};
    ++physical.steps;
    if (context.drive.watch) book_energies(context, before_.motion, before_.motion.x, before_.exchange);
    // Undo the flight if what the modes leave out moved a point behind an obstacle, or if uneven drag deformed the body too far.
    if (!off_obstacles(context, touching) || (flight_.modes().damped_unevenly && !rings_about_rest(context))) {
      physical = before_;
      touches = true;
    } else {
      physical.error.add({neglected * free});
      if (stiff.flown > 0) stiff.flown += neglected * free;
    }
  }
  if (!touches) return StepStatus::ok;
  book_unknown_phase(context, motion, energy, mean, physical.total_error());
  stiff.begin(Phase::impact);
  stiff.since = motion.time;
  return StepStatus::ok;
}

bool Flights::can_fly(const Beside& at, double least, double until) {
  if (!rings_about_rest(at.context)) return false;
  const double most = until - at.context.run.physical.motion.time;
  const double free = flight_.until_touch(at.context.equations(), std::min(most, 2 * least), use::shortest_advance * at.limit, false);
  return free >= std::min(most, least);
}

Flights::PhaseError Flights::phase_error(const Beside& at, const State& other, const Outlook& ahead) {
  const StepContext& context = at.context;
  const State& motion = context.run.physical.motion;
  const Equations equations = context.equations();
  flight_.enter(equations, motion.time, other);
  flight_.remember();
  flight_.enter(equations, motion.time, motion);
  context.run.control.work += 3 * use::entry_work;
  const double between = flight_.difference(), mean = flight_.mean_frequency();
  PhaseError found{.apart = mean > 0 ? between / mean : 0};
  const double next = flight_.until_touch(equations, ahead.left, 0, true);
  if (next >= ahead.left) return found;
  const double energy = flight_.energy_after(next);
  const RigidState& rigid = flight_.rigid();
  const RigidMotion then{.centre = rigid.centre, .velocity = rigid.velocity, .spin = rigid.spin};
  const double speed = approach_speed(context, motion, then, flight_.modes().radius);
  const double time = std::min(ahead.left - next, ahead.pressing > 0 ? 4 * speed / ahead.pressing : infinity);
  const double effect = use::rebound_fraction * std::sqrt(2 * energy / flight_.modes().mass) * time;
  found.gain = effect > use::window_fraction * context.request.tolerance ? mean / speed * effect : 0;
  found.at_impact = use::echo_fraction * ahead.along_plane * between * flight_.remaining(next) * (1 - next / ahead.left) / 3;
  return found;
}

}  // namespace softffd
