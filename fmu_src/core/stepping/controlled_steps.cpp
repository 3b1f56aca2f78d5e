#include "stepping/controlled_steps.hpp"

#include <algorithm>
#include <cmath>

#include "kit/limits.hpp"
#include "kit/thresholds.hpp"
#include "kit/tumbling.hpp"
#include "model/arithmetic.hpp"

namespace softffd {

namespace thresholds {

/// Smallest and largest factor of the step; growth if the error is zero [1] (Hairer, Norsett, Wanner 1993, section II.4).
constexpr double shrink = 0.1, growth = 6, growth_without_error = 5;
/// After a rejected step, the next step is at most this fraction of the rejected one [1].
constexpr double after_rejection = 0.9;
/// The same if an old factor of the matrix may be at fault: the matrix is factored anew, at a step between these fractions [1].
constexpr double old_factor_shrink = 0.5, old_factor_keep = 0.95;
/// An implicit method keeps its step, and with it the factor of its matrix, if the wanted change lies between these [1]: measured, a kept
/// factor is worth a factor of 1.5 to 2.4.
constexpr double keep_below = 0.95, keep_above = 1.5;
/// A step that turns the body by more than the first multiple of the limit is repeated with the second fraction of its length [1].
constexpr double turned_too_far = 2, turned_shrink = 0.5;
/// A step that the communication point has cut to less than this fraction says nothing about the next step [1].
constexpr double cut_short = 0.2;
/// First step in units of 1 / omega [1].
constexpr double first_step = 3;
/// Shortest step relative to the times [1].
constexpr double shortest_step = 1e-14;

}  // namespace thresholds

namespace {

namespace use = thresholds;

/// Error that one step of length h may have [m]: errors add up until damping forgets them, and grow while a body tumbles.
class Allowance {
 public:
  Allowance(const StepContext& context, const Traits& traits, double growth)
      : traits_(traits),
        forgets_(std::min(context.request.horizon, context.model.longest_memory)),
        rounding_(position_rounding(context)),
        tolerance_(context.request.tolerance / growth * power(context.request.step_factor, traits.order)) {}
  double operator()(double h) const {
    return std::max(rounding_, std::min(traits_.tolerance_step, traits_.tolerance_sum * h / forgets_) * tolerance_);
  }

 private:
  const Traits& traits_;
  double forgets_, rounding_, tolerance_;
};

/// The step size controller: finds the size of the step after one of size `step` whose error is `ratio` times the allowed one.
struct Controller {
  double factor(double ratio, bool turned, int exponent) const {
    if (turned) return use::turned_shrink;
    if (ratio > 0) return use::safety * root(1 / ratio, exponent, use::shrink, use::growth);
    return ratio == 0 ? use::growth_without_error : use::shrink;
  }
  double after_rejection(double step, double factor, bool old_factor) const {
    return step * (old_factor ? std::clamp(factor, use::old_factor_shrink, use::old_factor_keep) : std::min(factor, use::after_rejection));
  }
  /// h: the step wanted so far; the communication point may have cut `step`. A cut step shows that the step may be longer only as far as it
  /// was tried. keeps_factor: the method's matrix stays as long as its step.
  double after_success(double h, double step, double factor, bool keeps_factor) const {
    if (keeps_factor && factor > use::keep_below && factor < use::keep_above) return h;
    const bool says_something = factor * step > h || (factor < use::growth_without_error && step > use::cut_short * h);
    return says_something ? step * factor : h;
  }
};

}  // namespace

StepStatus run_controlled(Integrators& integrators, const StepContext& context, Method method, double end, double pause_at) {
  Run& run = context.run;
  State& motion = run.physical.motion;
  ControllerState& control = run.control;
  OneStep& integrator = integrators.one_step(method);
  const Traits& t = traits(method);
  const double growth = tumbling_growth(context);
  const Allowance allowed(context, t, t.turning == Turning::in_frame ? 1 : growth);  // in the frame, deformations do not grow
  const Controller controller;
  double& h = control.controlled_step(method);
  const bool planes = !context.drive.planes.empty(), straight = t.turning == Turning::straight, in_frame = t.turning == Turning::in_frame;
  const double least = use::shortest_step * std::max(std::abs(end), end - motion.time);
  double limit = step_limit(context, method, false);
  // In the frame the first step is as long as possible: short steps would follow the vibrations that it is to pass over.
  const bool short_first = context.model.stability.elastic() && !in_frame;
  if (!(h > 0)) h = context.request.step_factor * std::min(end - motion.time, short_first ? use::first_step / bound(context) : infinity);
  run.physical.clock = {motion.time, h, 0};
  Budget& budget = integrators.budget();
  for (Count tries = 1; motion.time < end; ++tries) {
    if (budget.spent()) return StepStatus::too_much_work;
    const double left = end - motion.time;
    const Count ahead = divisions(left, tighter(h, limit));  // equal parts, so that no sliver is left at the end
    const double step = ahead == 1 ? left : left / double(ahead);
    if (!(step > least)) return StepStatus::not_finite;
    const Outcome offered = integrator.offer(context.model, context.drive, motion.time, step, run);
    control.work += offered.work;
    budget.spend(offered.work);
    const double ratio = offered.error / allowed(step);
    const bool turned = straight && step > use::turned_too_far * turning_limit(context, integrator.x, integrator.v);
    if (straight) limit = step_limit(context, method, false);
    const double factor = controller.factor(ratio, turned, integrator.exponent);
    if (!(ratio <= 1) || turned) {
      ++control.rejected;
      const bool old_factor = t.solves && control.factored.uses > 1;
      if (old_factor) control.factored.h = 0;
      h = controller.after_rejection(step, factor, old_factor);
      if (in_frame && control.work >= pause_at) return StepStatus::ok;
      continue;
    }
    h = controller.after_success(h, step, factor, t.solves);
    if (planes && integrators.passes(context, method, motion.time, step, motion.x, motion.v, integrator.x, integrator.v))
      return StepStatus::contact_ahead;
    integrator.keep(context.model, run);
    ++run.physical.steps;
    run.physical.clock.h = step;
    motion.time = ahead == 1 ? end : motion.time + step;
    if (control.work >= pause_at) return StepStatus::ok;
    if (tries % use::look_every == 0 && deformed_since_bound(context)) limit = step_limit(context, method, false);
  }
  return StepStatus::ok;
}

}  // namespace softffd
