#include "stepping/trial_runs.hpp"

#include <algorithm>

#include "kit/limits.hpp"
#include "kit/outlook.hpp"
#include "kit/snapshot.hpp"
#include "kit/thresholds.hpp"
#include "kit/tumbling.hpp"
#include "methods/ros34pw2.hpp"
#include "model/arithmetic.hpp"
#include "stepping/controlled_steps.hpp"
#include "watch/vibration.hpp"

namespace softffd {

namespace thresholds {

/// Rounds of a calibration in trial runs: the first ones of leapfrog, those of bm4, the further ones of leapfrog.
constexpr int trial_rounds = 1, trial_rounds_bm4 = 2, trial_rounds_left = 3;
/// Work between two trial runs in multiples of the trial runs' own work, and its limit while the winner stays [1].
/// Measured with a pause that was not bound to their work: trial runs took 5 to 30 % of a run of a second. With these pauses they take a
/// tenth at most, and less while the winner stays.
constexpr double trial_pause = 10, longest_trial_pause = 160;
/// Work that a trial of implicit steps may take; fraction of the work of explicit steps in the rest of the run for its matrices [1].
constexpr double longest_trial = 20'000, trial_fraction = 0.1;
/// Number of implicit steps in the place of one, by which it is seen that the fastest mode creeps.
constexpr Count creep_parts = 16;
/// Vibrations whose time scale is above this many implicit steps are resolved by the error control of these steps [1]. By experience.
constexpr double resolved = 8;
/// Length of the trial of a method with error control in units of 1 / omega [1]: some steps, until the method has found their size.
constexpr double controlled_window = 30;
/// Change of the moments of inertia by a vibration in units of the square of its size relative to the body [1]: with 1, a slab of 1e7 N/m
/// that flips over ended 12 tolerances off.
constexpr double inertia_by_vibration = 16;

}  // namespace thresholds

namespace {

namespace use = thresholds;

/// True if internal damping leaves the fastest modes no vibration.
bool creeps(const StepContext& context) {
  const Body& body = context.model.body;
  return body.dashpots() && body.shortest_time() * bound(context) >= use::creeping;
}

double fixed_work(const StepContext& context, Method method, double H) {
  const double h = tighter(step_limit(context, method, false), context.run.control.calibration(method).h);
  return double(divisions(H, h)) * step_work(context.model.body, context.drive, context.run, method, h);
}

/// Size of the vibrations with time scales below `slowest` [s], and of what it does to a body that tumbles [m]: a vibration changes the
/// moments of inertia by about the square of its size relative to the body, and the flips by as much times the growth of errors.
double passed_over(const StepContext& context, const State& motion, double slowest) {
  const double size = present_vibration(context.equations(), motion, context.model.time_scale, slowest);
  return size + use::inertia_by_vibration * (growth_from(context, motion).largest - 1) * size * size / context.model.body.length;
}

}  // namespace

bool TrialRuns::due(const StepContext& context, double H) {
  const ControllerState& control = context.run.control;
  const bool due = control.work >= control.trials.due && H >= use::sliver * control.usual;
  return control.trials.winner == Method::automatic || due || use::sliver * H > control.trials.window;
}

void TrialRuns::run(Integrators& integrators, Calibrator& calibrator, const StepContext& context, double H) {
  const auto calibrate = [&](Method method, int rounds) { spent_ += calibrator.calibrate(integrators, context, method, H, rounds); };
  const Body& body = context.model.body;
  spent_ = 0;
  Candidates candidates;
  candidates.before = context.run.control.trials.winner;
  const double longest = step_limit(context, Method::leapfrog, false),
               each = step_work(body, context.drive, context.run, Method::leapfrog, longest);
  candidates.least = std::max(1.0, H / longest) * each;
  const double slower = each / traits(Method::leapfrog).work;  // factor by internal damping, which implicit steps hardly feel
  const bool may_pay = context.model.stability.elastic() && !body.explicit_alone && implicit_may_pay(slower * H * bound(context));
  if (may_pay) try_implicit(integrators, context, H, candidates.least, candidates);
  if (!(candidates.implicit_work < infinity)) {
    calibrate(Method::leapfrog, use::trial_rounds);
    candidates.leapfrog = fixed_work(context, Method::leapfrog, H);
    if (!leapfrog_is_enough(candidates)) {
      candidates.adaptive = body.damped ? Method::dop853 : Method::rkn12;
      const double least =
          H / step_limit(context, candidates.adaptive, false) * traits(candidates.adaptive).work;  // with internal damping this is much
      if (!body.dashpots() || least < candidates.leapfrog)
        candidates.adaptive_work = controlled_work(integrators, context, candidates.adaptive, H);
      if (!body.dashpots()) {
        calibrate(Method::bm4, use::trial_rounds_bm4);
        candidates.bm4 = fixed_work(context, Method::bm4, H);
      }
      if (may_pay && body.dashpots()) try_implicit(integrators, context, H, best_of(candidates).work, candidates);
      if (best_of(candidates).method == Method::leapfrog) calibrate(Method::leapfrog, use::trial_rounds_left);
    }
  }
  const Winner winner = best_of(candidates);
  TrialRecord& record = context.run.control.trials;
  const double work = context.run.control.work;
  record.winner = winner.method;
  record.reason = winner.reason;
  record.forecast = winner.work;
  record.window = H;
  record.pause = winner.method == candidates.before ? std::min(2 * record.pause, use::longest_trial_pause) : use::trial_pause;
  record.due = work + std::max(record.pause * spent_, use::shortest_pause);
}

/// Checks, without touching a matrix first, whether implicit steps could pay and nothing vibrates by more than they may ignore; then tries
/// them. others: work of the other methods. At first this is the work of leapfrog at its stability limit, of which strong internal damping
/// leaves little accuracy. Where the tolerance asks for much more work, the trial runs call again with that work.
void TrialRuns::try_implicit(Integrators& integrators, const StepContext& context, double H, double others, Candidates& candidates) {
  const State& motion = context.run.physical.motion;
  candidates.implicit = implicit_method(!context.drive.pins.empty(), H * bound(context), turning_limit(context, motion.x, motion.v) < H);
  const double step_work = integrators.implicit_work().step;
  const double matrices = (1 + double(creeps(context) ? use::creep_parts : 1)) * integrators.implicit_work().factor;
  if (matrices > use::trial_fraction * others * left_of_run(context) / H) return;
  if (!implicit_may_win(H / step_limit(context, candidates.implicit, false) * step_work, others)) return;
  const double shortest = H * step_work / (use::implicit_gain * others);  // the step that would still pay
  if (too_loud(passed_over(context, motion, use::resolved * shortest), context.request.tolerance)) return;
  const double budget = std::min(use::implicit_gain * others, use::longest_trial);
  candidates.implicit_work = implicit_work(integrators, context, candidates.implicit, H, budget);
}

/// True if one implicit step agrees with explicit steps that resolve everything. Error estimates of implicit steps do not see what the
/// steps damp. Where internal damping leaves fast modes no vibration, the comparison is with shorter implicit steps: explicit steps err
/// there themselves.
bool TrialRuns::fast_modes_are_quiet(Integrators& integrators, const StepContext& context, Method method, double H) {
  const ImplicitWork& implicit = integrators.implicit_work();
  State& motion = context.run.physical.motion;
  const bool creep = creeps(context);
  const double longest = creep ? step_limit(context, method, false) : infinity;  // no step of the method turns the body further
  const double way = std::min({H, use::calibration_window / bound(context), longest}), begin = motion.time;
  const Method fine = creep ? method : Method::leapfrog;
  const Count steps = creep ? use::creep_parts : divisions(way, step_limit(context, Method::leapfrog, false));
  const double each =
      creep ? implicit.step + implicit.factor : step_work(context.model.body, context.drive, context.run, fine, way / double(steps));
  spent_ += double(steps) * each + implicit.step + implicit.factor;
  Snapshot snapshot(context.run, start_);
  if (integrators.take(context, fine, {begin, 0, way / double(steps), steps}).status != StepStatus::ok) return false;
  std::swap(fine_, motion);
  snapshot.rollback();
  OneStep& step = integrators.one_step(method);
  integrators.budget().spend(step.offer(context.model, context.drive, begin, way, context.run).work);
  const double tumbled = turned_apart(context, fine_, step.x);
  fine_.x -= step.x;
  fine_.v -= step.v;
  const std::size_t n = fine_.x.size();
  const double by_velocity = kernels::largest_weighted(n, context.model.time_scale.data(), fine_.v.data());
  return quiet(worse(tumbled, worse(kernels::largest(n, fine_.x.data()), by_velocity)), context.request.tolerance);
}

/// Work of an implicit method for H, found by doing it; infinite beyond the budget, or if fast modes are at work that it would damp.
double TrialRuns::implicit_work(Integrators& integrators, const StepContext& context, Method method, double H, double budget) {
  if (!fast_modes_are_quiet(integrators, context, method, H)) return infinity;
  Run& run = context.run;
  Snapshot snapshot(run, start_);
  const Run& before = snapshot.before();
  const double end = run.physical.motion.time + H;
  const StepStatus status = run_controlled(integrators, context, method, end, run.control.work + budget);
  const double work = run.control.work - before.control.work;
  spent_ += work;
  if (status != StepStatus::ok || run.physical.motion.time < end) return infinity;
  const double longest = use::resolved * run.control.controlled_step(method);
  if (too_loud(passed_over(context, before.physical.motion, longest), context.request.tolerance)) return infinity;
  snapshot.commit();
  // a factor is kept for later communication steps
  const double made = double(run.control.factors - before.control.factors),
               used = std::max(1.0, double(run.physical.steps - before.physical.steps));
  return work - integrators.implicit_work().factor * std::max(0.0, made - used / double(Ros34pw2::most_uses));
}

double TrialRuns::controlled_work(Integrators& integrators, const StepContext& context, Method method, double H) {
  const double window = std::min(H, use::controlled_window / bound(context));
  double h = 0;
  {
    Snapshot snapshot(context.run, start_);
    const StepStatus status = run_controlled(integrators, context, method, context.run.physical.motion.time + window, infinity);
    spent_ += context.run.control.work - snapshot.before().control.work;
    if (status != StepStatus::ok) return infinity;
    h = context.run.control.controlled_step(method);
  }
  context.run.control.controlled_step(method) = h;
  return double(divisions(H, tighter(h, step_limit(context, method, false)))) * traits(method).work;
}

}  // namespace softffd
