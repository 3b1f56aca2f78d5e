/// Steps under error control: the step size controller of the methods that estimate their error.
#pragma once
#include "kit/integrators.hpp"

namespace softffd {

/// Runs from the present time to `end`, or to the end of the first step after `pause_at` [work].
StepStatus run_controlled(Integrators& integrators, const StepContext& context, Method method, double end, double pause_at);

}  // namespace softffd
