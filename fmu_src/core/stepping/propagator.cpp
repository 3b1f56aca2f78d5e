#include "stepping/propagator.hpp"

#include <algorithm>

#include "contact/tolerances.hpp"
#include "kit/implicit_steps.hpp"
#include "kit/limits.hpp"
#include "kit/trial.hpp"
#include "model/arithmetic.hpp"
#include "stepping/controlled_steps.hpp"
#include "stepping/fixed_steps.hpp"

namespace softffd {

namespace thresholds {

/// Work of a communication step by forecast, relative to what is left, at which it is refused before it is done [1]: forecasts err.
constexpr double too_long = 1.2;
/// Explicit steps in what is left of a communication step, from which on a pinned body with internal damping takes implicit ones where no
/// race has found any [1].
constexpr double stiff_damping = 500;
/// What is left per communication step of the length that is remembered of those of late [1].
constexpr double usual_decay = 0.8;
/// A winner that needs so many times the forecast runs again [1].
constexpr double overrun = 2.5;

}  // namespace thresholds

namespace {

namespace use = thresholds;

}  // namespace

StepStatus Propagator::advance(const Job& job, double H) {
  Course& course = job.run.course;
  course.usual = std::max(H, use::usual_decay * course.usual);
  if (!plans_every_given_step(facts(job, H))) return advance_planned(job, H);
  const Clock& clock = job.run.path.clock;
  for (Count left = counted_units(job.request, H); left > 0; --left) {
    if (clock.unit == job.request.step && !budget().covers(double(left) * double(clock.parts))) return StepStatus::too_much_work;
    const StepStatus status = advance_planned(job, job.request.step);
    if (status != StepStatus::ok) return status;
  }
  return StepStatus::ok;
}

/// What is known at once.
Facts Propagator::facts(const Job& job, double H) const {
  Facts facts;
  facts.asked = job.request.method;
  facts.given_step = job.request.step > 0;
  facts.counted = counted_units(job.request, H) > 0;
  facts.length = job.request.horizon / H;
  facts.damped = job.model.body.damped;
  facts.dashpots = job.model.body.dashpots();
  facts.obstacles = !job.drive.planes.empty();
  facts.surface = facts.obstacles && job.model.body.samples;
  facts.pins = !job.drive.pins.empty();
  if (facts.obstacles && job.drive.planes.back().solid()) {  // near, and round: flights and rests know planes alone
    facts.clear = false;
    facts.within_reach = true;
    facts.stiffness = 0;
  }
  return facts;
}

void Propagator::find(Want want, const Job& job, double H, Facts& facts) {
  const State& motion = job.run.path.motion;
  if (want == Want::clear) facts.clear = off_obstacles(job.drive, motion.time, motion.x, touching * job.model.body.length);
  if (want == Want::within_reach) facts.within_reach = integrators_.reach().may_touch(job.equations(), motion, H);
  if (want == Want::rings) facts.rings = impacts_.of(lattice_, job.run).rings_about_rest(job);
  if (want == Want::stiffness) facts.stiffness = H / step_limit(job, Method::leapfrog, false);
}

StepStatus Propagator::advance_planned(const Job& job, double H) {
  Facts known = facts(job, H);
  while (true) {
    const Plan next = plan(known);
    if (next.want != Want::nothing) {
      find(next.want, job, H, known);
      continue;
    }
    if (next.retreat == Retreat::never) return carry_out(job, next, H);
    Trial trial(job.run.path, start_);
    const StepStatus status = carry_out(job, next, H);
    if (!retreats(job, next, status, known)) {
      trial.keep();
      return status;
    }
  }
}

/// Whether a plan's stretch has to be planned again; its steps are rejected then.
bool Propagator::retreats(const Job& job, const Plan& plan, StepStatus status, Facts& facts) {
  if (plan.retreat == Retreat::never || status != StepStatus::contact_ahead) return false;
  facts.came_upon_obstacle = true;
  job.run.course.rejected += job.run.path.steps - start_.steps;
  return true;
}

StepStatus Propagator::carry_out(const Job& job, const Plan& plan, double H) {
  Course& course = job.run.course;
  const double begun = job.run.path.motion.time, end = begun + H;
  if (plan.method != course.method) job.run.path.clock.unit = 0;  // how a given step is divided was for the other method
  course.method = plan.method;
  course.reason = plan.reason;
  if (plan.steps != Steps::impacts && !job.drive.planes.empty()) job.run.path.stiff.begin(Phase::flight);
  switch (plan.steps) {
    case Steps::implicit: return run_implicit(integrators_, job, plan.method, end);
    case Steps::damped:
      return damped_.of(lattice_, job.run).run(integrators_, job, end, job.drive.planes.empty() ? nullptr : &doubled_.of(job.run));
    case Steps::doubled: return doubled_.of(job.run).run(integrators_, job, end);
    case Steps::counted: return run_counted(integrators_, job, plan.method, counted_units(job.request, H));
    case Steps::controlled: return begun < end ? run_controlled(integrators_, job, plan.method, end, infinity) : StepStatus::ok;
    case Steps::impacts: return impacts_.of(lattice_, job.run).run(integrators_, job, end, plan.rings);
    case Steps::fitted:
      return begun < end ? run_fitted(integrators_, calibrator_.of(job.run), job, plan.method, end, infinity) : StepStatus::ok;
    case Steps::raced: return run_raced(job, end);
  }
  return StepStatus::ok;
}

StepStatus Propagator::run_raced(const Job& job, double end) {
  Course& course = job.run.course;
  const State& motion = job.run.path.motion;
  while (motion.time < end) {
    const double left = end - motion.time;
    if (Race::due(job, left)) race_.of(job.run).run(integrators_, calibrator_.of(job.run), job, left);
    const Method method = course.method = course.race.winner;
    course.reason = course.race.reason;
    if (motion.time == end) break;  // a trial took it there
    const bool creeps = !job.drive.pins.empty() && job.model.body.dashpots() && job.request.method == Method::automatic;
    if (creeps && !is_implicit(method) && left / step_limit(job, Method::leapfrog, false) > use::stiff_damping) {
      course.reason = Reason::quiet_stiffness;
      return damped_.of(lattice_, job.run).run(integrators_, job, end, nullptr);
    }
    if (course.race.forecast > use::too_long * budget().left()) return StepStatus::too_much_work;
    const double pause_at = std::min(course.race.due, course.work + use::overrun * course.race.forecast + use::shortest_pause);
    const StepStatus status = traits(method).error_control()
                                  ? run_controlled(integrators_, job, method, end, pause_at)
                                  : run_fitted(integrators_, calibrator_.of(job.run), job, method, end, pause_at);
    if (status != StepStatus::ok) return status;
    if (motion.time < end) course.race.due = course.work;
  }
  return StepStatus::ok;
}

}  // namespace softffd
