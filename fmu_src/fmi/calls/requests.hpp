/// Requests that the functions of both standards make behind the guard: log categories and the experiment.
#pragma once
#include "calls/guard.hpp"

namespace softffd::fmi {

fmi2Status switch_logging(Instance& instance, const Function& function, bool on, std::size_t count, const char* const* categories);

/// Start time [s] and, if they are given, tolerance and stop time [s]. `set_up` throws CallError if a value is invalid.
struct Experiment {
  double start;
  const double* tolerance;  ///< null: not given
  const double* stop;
};
void set_up(Instance& instance, const Experiment& experiment);

}  // namespace softffd::fmi
