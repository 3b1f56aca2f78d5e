/// Implicit steps with contact: steps of the given size, or one step for the rest of the communication step.
#pragma once
#include "kit/integrators.hpp"

namespace softffd {

StepStatus run_implicit(Integrators& integrators, const StepContext& context, Method method, double end);

}  // namespace softffd
