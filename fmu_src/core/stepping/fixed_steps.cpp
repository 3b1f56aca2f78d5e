#include "stepping/fixed_steps.hpp"

#include <algorithm>
#include <cmath>

#include "kit/limits.hpp"
#include "kit/thresholds.hpp"
#include "model/arithmetic.hpp"

namespace softffd {

namespace thresholds {

/// Largest number of given steps that can be counted exactly [1].
constexpr double countable = 0x1p53;
/// A step is made longer again only by this factor or more [1]: with every change a method loses its coefficients for the step.
constexpr double regrowth = 1.25;
/// Rounds of a calibration within a run.
constexpr int calibration_rounds = 4;

}  // namespace thresholds

namespace {

namespace use = thresholds;

/// Divides each internal step of the current unit into this many.
void refine(Clock& clock, Count times) {
  const Count into = clock.count % clock.parts, parts = clock.parts * times;
  clock = {clock.origin + double(clock.count - into) * clock.h, clock.unit / double(parts), into * times, clock.unit, parts};
}

/// Divides the given step as stability requires at the present state. A check of a divided step holds from the next unit on, or at once if
/// the step must be finer. A step that has to be divided keeps the distance from the limit that automatic steps keep: close to the limit
/// every vibration would change the division, and feed itself by that.
StepStatus divide_unit(const Budget& budget, const StepContext& context, Method method) {
  Clock& clock = context.run.physical.clock;
  const double unit = context.request.step, wanted = unit * context.request.step_factor;
  const Count into = clock.unit == unit ? clock.count % clock.parts : 0;
  const double limit = tighter(wanted, step_limit(context, method, true));
  const bool again = context.request.step_factor < 1;  // no result so far: divided as much as it must be, anew at every unit
  const double target = limit < wanted && !again ? tighter(limit, step_limit(context, method, false)) : limit;
  const double work = unit / target * step_work(context.model.body, context.drive, context.run, method, target);
  if (!budget.covers(work)) return refusal(work);
  const bool too_long = divisions(clock.h, limit) > 1;
  if (into == 0 && (clock.unit != unit || too_long || again || target > use::regrowth * clock.h)) {
    const Count parts = divisions(unit, target);
    clock = {context.run.physical.motion.time, unit / double(parts), 0, unit, parts};
  } else if (too_long) {
    refine(clock, divisions(clock.h, target));
  }
  return StepStatus::ok;
}

StepStatus run_stretch(Integrators& integrators, const StepContext& context, Method method, Count steps) {
  PhysicalState& physical = context.run.physical;
  const Span span{physical.clock.origin, physical.clock.count, physical.clock.h, steps};
  physical.clock.count += steps;
  physical.steps += steps;
  const Outcome outcome = integrators.take(context, method, span);
  context.run.control.work += outcome.work;
  return outcome.status;
}

}  // namespace

Count counted_units(const Request& request, double H) {
  const double units = request.step > 0 ? std::round(H / request.step) : 0;
  return units >= 1 && units <= use::countable && std::abs(H - units * request.step) <= 1e-9 * H ? Count(units) : 0;
}

/// Checks of the deformation are counted, so that they fall on the same moments however the time is divided.
StepStatus run_counted(Integrators& integrators, const StepContext& context, Method method, Count units) {
  Clock& clock = context.run.physical.clock;
  const Budget& budget = integrators.budget();
  while (units > 0) {
    const bool other = clock.unit != context.request.step;
    const bool begins_divided = !other && clock.parts > 1 && clock.count % clock.parts == 0;
    if (other || context.run.control.bound < 0 || clock.count % use::look_every == 0 || begins_divided || context.request.step_factor < 1)
      if (const StepStatus status = divide_unit(budget, context, method); status != StepStatus::ok) return status;
    if (!budget.covers(double(units) * double(clock.parts) * step_work(context.model.body, context.drive, context.run, method, clock.h)))
      return StepStatus::too_much_work;
    const Count left = clock.parts > 1 ? clock.parts - clock.count % clock.parts : units;
    const Count ahead = std::min(left, use::look_every - clock.count % use::look_every);
    const StepStatus status = run_stretch(integrators, context, method, ahead);
    if (status != StepStatus::ok) return status;
    context.run.physical.motion.time = clock.time();
    if (clock.parts == 1)
      units -= ahead;
    else if (clock.count % clock.parts == 0)
      --units;
  }
  return StepStatus::ok;
}

StepStatus run_fitted(Integrators& integrators, Calibrator& calibrator, const StepContext& context, Method method, double end,
                      double pause_at) {
  State& motion = context.run.physical.motion;
  Clock& clock = context.run.physical.clock;
  const Request& request = context.request;
  const bool given = request.step > 0;
  const bool stable_only = method == Method::central_difference && !context.drive.planes.empty();  // its contact does not converge
  Calibration& calibration = context.run.control.calibration(method);
  Count steps = 0;
  while (true) {
    if (stable_only)
      calibration.h = infinity;
    else if (!given && calibrator.due(context, method, end - motion.time))
      calibrator.calibrate(integrators, context, method, end - motion.time, use::calibration_rounds);
    const double limit = tighter(step_limit(context, method, given), request.step_factor * (given ? request.step : calibration.h));
    if (steps == 0 || !(clock.h <= limit) || limit > use::regrowth * clock.h) {
      const double left = end - motion.time;
      const double work = left / limit * traits(method).work;
      if (!integrators.budget().covers(work)) return refusal(work);
      steps = divisions(left, limit);
      clock = {motion.time, left / double(steps), 0};
    }
    const Count ahead = std::min(steps, use::look_every);
    const StepStatus status = run_stretch(integrators, context, method, ahead);
    if (status != StepStatus::ok) return status;
    steps -= ahead;
    motion.time = steps == 0 ? end : clock.time();
    if (steps == 0 || context.run.control.work >= pause_at) return StepStatus::ok;
  }
}

}  // namespace softffd
