#include "stepping/calibration.hpp"

#include <algorithm>
#include <cmath>

#include "kit/limits.hpp"
#include "kit/snapshot.hpp"
#include "kit/thresholds.hpp"
#include "kit/tumbling.hpp"
#include "model/arithmetic.hpp"
#include "watch/vibration.hpp"

namespace softffd {

namespace thresholds {

/// Largest number of steps of the coarser run: leapfrog, bm4.
constexpr Count calibration_steps = 40, calibration_steps_bm4 = 16;
/// Work between two calibrations, in multiples of a calibration's own work [1], so that they cost at most a tenth of a run.
constexpr double calibration_pause = 10;
/// A calibration is good enough if it changes the step by a factor above this: its extrapolation then follows the method's order [1].
constexpr double calibrated = 0.35;
/// Bounds of the factor by which one calibration may change the step [1].
constexpr double calibration_shrink = 1e-4, calibration_growth = 4;
/// Factor of the step after a trial without a finite result [1].
constexpr double after_failed_trial = 0.1;

}  // namespace thresholds

namespace {

namespace use = thresholds;

/// Returns the factor of the step after a trial with this error [m].
double next_factor(double allowed, double error, int order) {
  if (!std::isfinite(error)) return use::after_failed_trial;
  if (error == 0) return use::calibration_growth;
  return root(std::min(1e30, allowed / error), order, use::calibration_shrink, use::calibration_growth);
}

}  // namespace

bool Calibrator::due(const StepContext& context, Method method, double H) const {
  const ControllerState& control = context.run.control;
  const Calibration& calibration = context.run.control.calibration(method);
  if (calibration.h == 0) return true;
  if (H < use::sliver * control.usual) return false;
  const double window = context.model.stability.any_frequency() > 0 ? std::min(H, use::calibration_window / bound(context)) : H;
  return control.work >= calibration.due || use::sliver * window > calibration.window;
}

double Calibrator::calibrate(Integrators& integrators, const StepContext& context, Method method, double H, int rounds) {
  const Traits& t = traits(method);
  Calibration& calibration = context.run.control.calibration(method);
  const double window = context.model.stability.elastic() ? std::min(H, use::calibration_window / bound(context)) : H;
  const double allowed = use::forecast_tolerance * context.request.tolerance;
  const double pairs = power(2, t.order), c = pairs / (pairs - 1);
  const Count most = method == Method::bm4 ? use::calibration_steps_bm4 : use::calibration_steps;
  const double vibration = coming_vibration(context.equations(), context.run.physical.motion, context.model.time_scale, H);
  const double growth = tumbling_growth(context);
  const bool harmless = (context.model.body.damped ? growth : 1) * vibration <= allowed;
  context.run.control.vibration = vibration;
  context.run.control.stirred = 0;
  double h = std::min({H, step_limit(context, method, false), calibration.h > 0 ? calibration.h : infinity}), work = 0;
  for (int round = 0; round < rounds && !harmless; ++round) {
    const Count steps = std::min(divisions(window, h), most);
    h = std::min(h, window / double(steps));
    const std::optional<double> error = trial_error(integrators, context, method, h, steps);
    work += 3 * double(steps) * step_work(context.model.body, context.drive, context.run, method, h);
    const double factor = error ? next_factor(allowed, c * *error, t.order) : 1;
    calibration.h = h * factor;
    if (factor > use::calibrated) break;
    h = calibration.h;
  }
  if (harmless) calibration.h = infinity;
  calibration.window = window;
  calibration.due = context.run.control.work + std::max(use::calibration_pause * work, use::shortest_pause);
  return work;
}

/// Final error by the difference of runs with h and h / 2 [m]; infinite if one of them fails, nothing if one comes upon an obstacle.
std::optional<double> Calibrator::trial_error(Integrators& integrators, const StepContext& context, Method method, double h, Count steps) {
  PhysicalState& physical = context.run.physical;
  Snapshot snapshot(physical, start_);
  const double begin = physical.motion.time;
  StepStatus status = integrators.take(context, method, {begin, 0, h, steps}).status;
  if (status == StepStatus::ok) {
    std::swap(coarse_, physical.motion);
    snapshot.rollback();
    status = integrators.take(context, method, {begin, 0, h / 2, 2 * steps}).status;
  }
  if (status == StepStatus::contact_ahead) return {};
  return status == StepStatus::ok ? growing(context, coarse_, physical.motion, double(steps) * h) : infinity;
}

}  // namespace softffd
