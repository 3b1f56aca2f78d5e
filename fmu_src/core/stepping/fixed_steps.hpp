/// Steps of one size: a given one, counted so that no cut of the time changes it, and one that fits stability and tolerance.
#pragma once
#include "kit/integrators.hpp"
#include "stepping/calibration.hpp"

namespace softffd {

/// The given steps in a communication step, if they fit it without a rest and can be counted; else 0.
Count counted_units(const Request& request, double H);
/// So many given steps, each divided where stability asks for it.
StepStatus run_counted(Integrators& integrators, const StepContext& context, Method method, Count units);
/// From the present time to `end`, or to the first look after `pause_at` [work].
StepStatus run_fitted(Integrators& integrators, Calibrator& calibrator, const StepContext& context, Method method, double end,
                      double pause_at);

}  // namespace softffd
