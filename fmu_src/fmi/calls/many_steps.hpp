/// Takes many communication steps of a component one after the other, for the Python package: a host's loop without a host between the
/// calls. It calls only the functions of the standard, from any library.
#pragma once
#include <cstddef>

#include <fmi2FunctionTypes.h>

#include "machine/exported.hpp"

namespace softffd::fmi {

/// Variables and their values at all communication points.
template <class Value, class Row>
struct Recorded {
  std::size_t count;
  const fmi2ValueReference* references;
  Value* values;  ///< (count) array that is passed to the component
  Row* rows;      ///< (steps + 1, count) recorded values, or given ones for inputs
};

struct ManySteps {
  fmi2Component component;
  fmi2SetRealTYPE* set_real;
  fmi2GetRealTYPE* get_real;
  fmi2GetIntegerTYPE* get_integer;
  fmi2DoStepTYPE* do_step;
  const double* times;  ///< (steps + 1) communication points [s]
  const double* steps;  ///< (steps) step lengths [s]
  Recorded<fmi2Real, double> inputs, reals;
  Recorded<fmi2Integer, long long> integers;
  long long done;  ///< number of steps done and recorded; up to date also for a logger called during a step
};

}  // namespace softffd::fmi

/// Continues until `until` steps are done. Inputs are set before each step except the first, whose inputs are set already. Returns fmi2OK,
/// or the status of the call that discarded or failed; `done` then does not count that step.
SOFTFFD_EXPORTED int softffd_many_steps(softffd::fmi::ManySteps* run, long long until);
