#include "impacts/flights.hpp"

#include <algorithm>
#include <cmath>

#include "contact/tolerances.hpp"
#include "kit/thresholds.hpp"
#include "model/arithmetic.hpp"

namespace softffd {

namespace thresholds {

// Steps are the largest stable explicit ones; what these rest on stands in kit/thresholds.hpp.

/// Steps that a flight takes at least: entering one costs as much.
constexpr double shortest_flight = 4;
/// Steps below which a further advance towards a touch is not worth it.
constexpr double shortest_advance = 0.25;
/// Work of taking a motion apart into modes, and of a flight.
constexpr double entry_work = 15, flight_work = 30;
/// Share of the vibrations' energy by which that of the modes may miss the body's own: beyond, the body is far from its rest shape [1].
constexpr double modal_mismatch = 0.01;
/// Share that the next rebound may feel of what two runs' vibrations differ by [1].
constexpr double echo_share = 0.3;

}  // namespace thresholds

namespace {

namespace use = thresholds;

}  // namespace

bool Flights::rings_about_rest(const Job& job) {
  const State& motion = job.run.path.motion;
  if (!job.drive.pins.empty() || !flight_.possible(job.model.body)) return false;
  job.run.course.work += use::entry_work;
  flight_.enter(job.equations(), motion.time, motion);
  const double left = left_of_run(job), drift = std::min(left, flight_.memory()) * flight_.neglected_rate();
  const double slight = use::window_share * job.request.tolerance / (use::rebound_share * left);  // speed that no rebound need have
  const double missed = std::max(job.model.noise, 0.5 * flight_.modes().mass * slight * slight);
  const double left_out = std::max(drift, flight_.neglected_way(job.equations()));
  return left_out <= use::window_share * job.request.tolerance &&
         flight_.energy_missed() <= use::modal_mismatch * flight_.energy() + missed;
}

StepStatus Flights::fly(const Beside& at, bool rings) {
  const Job& job = at.job;
  Path& path = job.run.path;
  StiffContact& stiff = path.stiff;
  State& motion = path.motion;
  if (!off_obstacles(job, touching) || !(rings || rings_about_rest(job))) {
    stiff.phase = Phase::contact;
    return StepStatus::ok;
  }
  before_ = path;
  const double most = at.end - motion.time, begun = motion.time;
  const double mean = flight_.mean_frequency(), energy = flight_.energy(), neglected = flight_.neglected_rate();
  const double free = flight_.until_touch(job.equations(), most, use::shortest_advance * at.limit, false);
  bool touches = free < most;
  if (!(touches && free < use::shortest_flight * at.limit)) {
    flight_.leave(job.equations(), motion);
    motion.time = touches ? begun + free : at.end;
    job.run.course.work += use::flight_work;
    at.integrators.budget().spend(use::entry_work + use::flight_work);
    job.run.course.method = Method::floating_frame;
    job.run.course.reason = Reason::ringing_flight;
    path.clock = {begun, free, 0};
    ++path.steps;
    if (job.drive.watch) book_energies(job, before_.motion, before_.motion.x, before_.exchange);
    if (!off_obstacles(job, touching)) {  // what is left out of the modes has brought a point behind an obstacle
      path = before_;
      touches = true;
    } else {
      stiff.error += neglected * free;
    }
  }
  if (!touches) return StepStatus::ok;
  const double beside = job.model.body.samples ? job.run.course.contact_error : 0;
  book_unknown_phase(job, motion, energy, mean, std::hypot(stiff.total_error(), beside));
  stiff.begin(Phase::impact);
  stiff.since = motion.time;
  return StepStatus::ok;
}

bool Flights::can_fly(const Beside& at, double least, double until) {
  if (!rings_about_rest(at.job)) return false;
  const double most = until - at.job.run.path.motion.time;
  const double free = flight_.until_touch(at.job.equations(), std::min(most, 2 * least), use::shortest_advance * at.limit, false);
  return free >= std::min(most, least);
}

double Flights::echo(const Beside& at, const State& other, const Outlook& ahead, double& gain) {
  const Job& job = at.job;
  const State& motion = job.run.path.motion;
  const Equations equations = job.equations();
  flight_.enter(equations, motion.time, other);
  flight_.remember();
  flight_.enter(equations, motion.time, motion);
  job.run.course.work += 3 * use::entry_work;
  const double between = flight_.difference(), mean = flight_.mean_frequency();
  const double next = flight_.until_touch(equations, ahead.left, 0, true);
  if (next >= ahead.left) return 0;
  const double energy = flight_.energy_after(next);
  const RigidState& rigid = flight_.rigid();
  const RigidMotion then{.centre = rigid.centre, .velocity = rigid.velocity, .spin = rigid.spin};
  const double speed = approach_speed(job, motion, then, flight_.modes().radius);
  const double time = std::min(ahead.left - next, ahead.pressing > 0 ? 4 * speed / ahead.pressing : infinity);
  const double effect = use::rebound_share * std::sqrt(2 * energy / flight_.modes().mass) * time;
  gain = effect > use::window_share * job.request.tolerance ? mean / speed * effect : 0;
  return use::echo_share * ahead.along_plane * between * flight_.remaining(next) * (1 - next / ahead.left) / 3;
}

}  // namespace softffd
