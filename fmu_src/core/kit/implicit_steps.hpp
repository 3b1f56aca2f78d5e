/// Steps of a stiff body in contact: one implicit step for the communication step, or the given ones.
#pragma once
#include "kit/integrators.hpp"

namespace softffd {

StepStatus run_implicit(Integrators& integrators, const Job& job, double end);

}  // namespace softffd
