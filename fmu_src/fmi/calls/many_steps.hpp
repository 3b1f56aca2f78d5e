/// Communication steps of a component one after the other, for the Python package: what a host's loop calls, without a host between the
/// calls. It calls the standard's functions alone, of whichever library they are.
#pragma once
#include <cstddef>

#include <fmi2FunctionTypes.h>

#include "machine/exported.hpp"

namespace softffd::fmi {

/// Some variables at all communication points.
template <class Value, class Row>
struct Recorded {
  std::size_t count;
  const fmi2ValueReference* references;
  Value* values;  ///< (count): handed to the component
  Row* rows;      ///< (steps + 1, count)
};

struct ManySteps {
  fmi2Component component;
  fmi2SetRealTYPE* set_real;
  fmi2GetRealTYPE* get_real;
  fmi2GetIntegerTYPE* get_integer;
  fmi2DoStepTYPE* do_step;
  const double* times;  ///< (steps + 1) [s]
  const double* steps;  ///< (steps) [s]
  Recorded<fmi2Real, double> inputs, reals;
  Recorded<fmi2Integer, long long> integers;
  long long done;  ///< steps that are done and recorded: true also for a logger that is called meanwhile
};

}  // namespace softffd::fmi

/// Goes on until `until` steps are done. Inputs are set before each step but the first, whose are set already. Returns the status of the
/// call that discarded or failed, where `done` stays at the step before, else fmi2OK.
SOFTFFD_EXPORTED int softffd_many_steps(softffd::fmi::ManySteps* run, long long until);
