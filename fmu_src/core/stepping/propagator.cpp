#include "stepping/propagator.hpp"

#include <algorithm>

#include "contact/tolerances.hpp"
#include "kit/implicit_steps.hpp"
#include "kit/limits.hpp"
#include "kit/snapshot.hpp"
#include "model/arithmetic.hpp"
#include "stepping/controlled_steps.hpp"
#include "stepping/fixed_steps.hpp"
#include "watch/vibration.hpp"

namespace softffd {

namespace thresholds {

/// A communication step is refused before it is done if its forecast work is above this multiple of what is left [1]: forecasts err.
constexpr double too_long = 1.2;
/// Factor per communication step by which the remembered length of recent communication steps decays [1].
constexpr double usual_decay = 0.8;
/// Trial runs are repeated if the winner needs this multiple of its forecast work [1].
constexpr double overrun = 2.5;
/// Trials are due at once if vibrations become larger by this factor than those that they were made for [1].
constexpr double more_vibration = 2;
/// A body's deformation limits its way only in communication steps longer than its largest time scale by this factor [1].
constexpr double stiff_step = 10;

}  // namespace thresholds

namespace {

namespace use = thresholds;

/// Vibrations that the outside sets off need other steps than those before them, also if the next trials are not due yet.
void look_for_vibration(const StepContext& context, double H) {
  ControllerState& control = context.run.control;
  const double slight = use::forecast_tolerance * context.request.tolerance;
  control.stirred += context.request.stirs;
  if (control.stirred <= std::max(control.vibration, slight)) return;
  control.stirred = 0;
  const double vibration = coming_vibration(context.equations(), context.run.physical.motion, context.model.time_scale, H);
  if (!(vibration > use::more_vibration * control.vibration && vibration > slight)) return;
  control.vibration = vibration;
  control.doubt_steps();
}

}  // namespace

StepStatus Propagator::advance(const StepContext& context, double H) {
  ControllerState& control = context.run.control;
  control.usual = std::max(H, use::usual_decay * control.usual);
  if (!(context.request.step > 0)) look_for_vibration(context, H);
  if (!plans_every_given_step(facts(context, H))) return advance_planned(context, H);
  const Clock& clock = context.run.physical.clock;
  for (Count left = counted_units(context.request, H); left > 0; --left) {
    if (clock.unit == context.request.step && !budget().covers(double(left) * double(clock.parts))) return StepStatus::too_much_work;
    const StepStatus status = advance_planned(context, context.request.step);
    if (status != StepStatus::ok) return status;
  }
  return StepStatus::ok;
}

/// Returns the facts that are known at once.
Facts Propagator::facts(const StepContext& context, double H) const {
  Facts facts;
  facts.asked = context.request.method;
  facts.given_step = context.request.step > 0;
  facts.counted = counted_units(context.request, H) > 0;
  facts.length = context.request.horizon / H;
  facts.damped = context.model.body.damped;
  facts.dashpots = context.model.body.dashpots();
  facts.obstacles = !context.drive.planes.empty();
  facts.surface = facts.obstacles && context.model.body.samples;
  facts.pins = !context.drive.pins.empty();
  facts.explicit_alone = context.model.body.explicit_alone;
  const Drive& around = context.drive;
  if (facts.obstacles && (around.planes.back().solid() || !around.free.empty())) {  // only plans of contact know these
    facts.clear = false;
    facts.within_reach = true;
    if (facts.pins) facts.stiffness = 0;  // free obstacles may meet others
  }
  return facts;
}

/// True if a point could reach an obstacle within H. Forces over masses alone put every obstacle within reach of a stiff body in a long
/// step: what holds its points together bounds their way, too.
bool Propagator::may_touch(const StepContext& context, double H) {
  State& motion = context.run.physical.motion;
  const Equations equations = context.equations();
  BroadPhase& broad_phase = integrators_.broad_phase();
  if (!broad_phase.may_touch(equations, motion, H, forecast_way(equations, motion, H))) return false;
  const bool soft = H < use::stiff_step * context.model.time_scale.maxCoeff();
  if (soft || broad_phase.may_touch(equations, motion, H, 0)) return true;
  const double vibration = coming_vibration(equations, motion, context.model.time_scale, H);
  return broad_phase.may_touch(equations, motion, H, broad_phase.stiff_way(equations, motion, H, vibration));
}

void Propagator::find(Want want, const StepContext& context, double H, Facts& facts) {
  const State& motion = context.run.physical.motion;
  if (want == Want::clear) facts.clear = off_obstacles(context.drive, motion.time, motion.x, touching * context.model.body.length);
  if (want == Want::within_reach) facts.within_reach = may_touch(context, H);
  if (want == Want::rings) facts.rings = impacts_.of(lattice_, context.run).rings_about_rest(context);
  if (want == Want::stiffness) facts.stiffness = H / step_limit(context, Method::leapfrog, false);
}

StepStatus Propagator::advance_planned(const StepContext& context, double H) {
  Facts known = facts(context, H);
  while (true) {
    const Plan next = plan(known);
    if (next.want != Want::nothing) {
      find(next.want, context, H, known);
      continue;
    }
    if (next.rollback == Rollback::never) return carry_out(context, next, H);
    Snapshot snapshot(context.run.physical, start_);
    const StepStatus status = carry_out(context, next, H);
    if (!rolls_back(context, next, status, known)) {
      snapshot.commit();
      return status;
    }
  }
}

/// True if the sub-interval of a plan has to be planned again; its steps then count as rejected.
bool Propagator::rolls_back(const StepContext& context, const Plan& plan, StepStatus status, Facts& facts) {
  if (plan.rollback == Rollback::never || status != StepStatus::contact_ahead) return false;
  facts.came_upon_obstacle = true;
  context.run.control.rejected += context.run.physical.steps - start_.steps;
  return true;
}

StepStatus Propagator::carry_out(const StepContext& context, const Plan& plan, double H) {
  ControllerState& control = context.run.control;
  const double begun = context.run.physical.motion.time, end = begun + H;
  if (plan.method != control.method) context.run.physical.clock.unit = 0;  // the division of a given step was for the other method
  control.method = plan.method;
  control.reason = plan.reason;
  if (plan.steps != Steps::impacts && !context.drive.planes.empty()) context.run.physical.stiff.begin(Phase::flight);
  switch (plan.steps) {
    case Steps::implicit: return run_implicit(integrators_, context, plan.method, end);
    case Steps::damped:
      return damped_.of(lattice_, context.run)
          .run(integrators_, context, end, {.contact = context.drive.planes.empty() ? nullptr : &step_doubling_.of(context.run)});
    case Steps::doubled: return step_doubling_.of(context.run).run(integrators_, context, end);
    case Steps::counted: return run_counted(integrators_, context, plan.method, counted_units(context.request, H));
    case Steps::controlled: return begun < end ? run_controlled(integrators_, context, plan.method, end, infinity) : StepStatus::ok;
    case Steps::impacts: return impacts_.of(lattice_, context.run).run(integrators_, context, end, plan.rings);
    case Steps::fitted:
      return begun < end ? run_fitted(integrators_, calibrator_.of(context.run), context, plan.method, end, infinity) : StepStatus::ok;
    case Steps::by_trials: return run_by_trials(context, end);
  }
  return StepStatus::ok;
}

StepStatus Propagator::run_by_trials(const StepContext& context, double end) {
  ControllerState& control = context.run.control;
  const State& motion = context.run.physical.motion;
  const bool parts = std::ranges::any_of(context.drive.free, &FreeMotion::part);  // the other methods know no parts
  while (motion.time < end) {
    const double left = end - motion.time;
    if (parts) {
      control.trials.winner = Method::leapfrog;
      control.trials.reason = Reason::stability;
      control.trials.forecast = 0;
      control.trials.due = infinity;
    } else if (TrialRuns::due(context, left))
      trial_runs_.of(context.run).run(integrators_, calibrator_.of(context.run), context, left);
    const Method method = control.method = control.trials.winner;
    control.reason = control.trials.reason;
    if (motion.time == end) break;  // a trial run has done it
    const Body& body = context.model.body;
    const bool creeps =
        !context.drive.pins.empty() && body.dashpots() && context.request.method == Method::automatic && !body.explicit_alone;
    const DampedSteps::ExplicitSteps others{.free = &calibrator_.of(context.run)};
    if (creeps && !is_implicit(method) && left > DampedSteps::worth(integrators_, context, others)) {
      control.reason = Reason::damped_motion;
      return damped_.of(lattice_, context.run).run(integrators_, context, end, others);
    }
    if (control.trials.forecast > use::too_long * budget().left()) return StepStatus::too_much_work;
    const double pause_at = std::min(control.trials.due, control.work + use::overrun * control.trials.forecast + use::shortest_pause);
    const StepStatus status = traits(method).error_control()
                                  ? run_controlled(integrators_, context, method, end, pause_at)
                                  : run_fitted(integrators_, calibrator_.of(context.run), context, method, end, pause_at);
    if (status != StepStatus::ok) return status;
    if (motion.time < end) control.trials.due = control.work;
  }
  return StepStatus::ok;
}

}  // namespace softffd
