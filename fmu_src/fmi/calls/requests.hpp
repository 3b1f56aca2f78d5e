/// What hosts of both standards ask of an instance, behind the guard: its log categories, its experiment.
#pragma once
#include "calls/guard.hpp"

namespace softffd::fmi {

fmi2Status switch_logging(Instance& instance, const Function& function, bool on, std::size_t count, const char* const* categories);

/// Start and, where they are given, tolerance and stop time [s]. Throws CallError.
struct Experiment {
  double start;
  const double* tolerance;  ///< null: not given
  const double* stop;
};
void set_up(Instance& instance, const Experiment& experiment);

}  // namespace softffd::fmi
