/// Implicit steps with contact as they are given, or one for what is left of the communication step.
#pragma once
#include "kit/integrators.hpp"

namespace softffd {

StepStatus run_implicit(Integrators& integrators, const StepContext& context, Method method, double end);

}  // namespace softffd
