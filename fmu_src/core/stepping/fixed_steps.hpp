/// Steps of one size: given steps, counted so that no division of the time changes them, and steps that fit stability and tolerance.
#pragma once
#include "kit/integrators.hpp"
#include "stepping/calibration.hpp"

namespace softffd {

/// Number of given steps in a communication step, if they fit it without a rest and can be counted; else 0.
Count counted_units(const Request& request, double H);
/// Takes so many given steps, each divided if stability requires it.
StepStatus run_counted(Integrators& integrators, const StepContext& context, Method method, Count units);
/// Runs from the present time to `end`, or to the first check of the deformation after `pause_at` [work].
StepStatus run_fitted(Integrators& integrators, Calibrator& calibrator, const StepContext& context, Method method, double end,
                      double pause_at);

}  // namespace softffd
