#include "kit/implicit_steps.hpp"

#include <algorithm>
#include <cmath>

#include "kit/limits.hpp"
#include "kit/thresholds.hpp"

namespace softffd {

namespace thresholds {

/// Least work that an implicit step may take before it is given up: where a body buckles, explicit steps are no shorter way.
constexpr double buckling_work = 1e6;

}  // namespace thresholds

namespace use = thresholds;

StepStatus run_implicit(Integrators& integrators, const StepContext& context, Method method, double end) {
  PhysicalState& physical = context.run.physical;
  const double begin = physical.motion.time, H = end - begin;
  const Budget& budget = integrators.budget();
  context.run.control.method = method;
  const double wanted = (context.request.step > 0 ? H / context.request.step : 1) / context.request.step_factor;
  const double least = wanted * traits(method).work;
  if (!budget.covers(least)) return refusal(least);
  const Count steps = std::max(Count{1}, Count(std::llround(wanted)));
  physical.clock = {begin, H / double(steps), 0};
  // A step that does not converge may take as much work as explicit steps in its place, with their several trials and dearer contact.
  const double longest = step_limit(context, Method::leapfrog, false);
  const double explicit_work =
      use::doubled_work * step_work(context.model.body, context.drive, context.run, Method::leapfrog, longest) * physical.clock.h / longest;
  const double most_work = std::max(explicit_work, use::buckling_work);
  for (Count i = 0; i < steps; ++i) {
    const double next = i + 1 == steps ? end : physical.clock.origin + double(i + 1) * physical.clock.h;
    const Span span{physical.motion.time, 0, next - physical.motion.time, 1, most_work};
    const Outcome outcome = integrators.take(context, method, span);
    context.run.control.work += outcome.work;
    if (outcome.status != StepStatus::ok) return outcome.status;
    physical.motion.time = next;
    ++physical.steps;
  }
  return StepStatus::ok;
}

}  // namespace softffd
