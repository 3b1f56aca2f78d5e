#include "calls/many_steps.hpp"

#include <algorithm>

namespace {

using softffd::fmi::ManySteps;

/// Sets the inputs, takes the step and reads the outputs. The first call that discards or fails ends the step. Returns its status.
fmi2Status one_step(const ManySteps& run, long long row) {
  const auto& inputs = run.inputs;
  const auto& reals = run.reals;
  const auto& integers = run.integers;
  fmi2Status status = fmi2OK;
  if (row > 0 && inputs.count > 0) {
    std::copy_n(inputs.rows + row * inputs.count, inputs.count, inputs.values);
    status = run.set_real(run.component, inputs.references, inputs.count, inputs.values);
  }
  if (status < fmi2Discard) status = run.do_step(run.component, run.times[row], run.steps[row], fmi2True);
  if (status < fmi2Discard) status = run.get_real(run.component, reals.references, reals.count, reals.rows + (row + 1) * reals.count);
  if (status < fmi2Discard && integers.count > 0) {
    status = run.get_integer(run.component, integers.references, integers.count, integers.values);
    std::copy_n(integers.values, integers.count, integers.rows + (row + 1) * integers.count);
  }
  return status;
}

}  // namespace

int softffd_many_steps(ManySteps* run, long long until) {
  while (run->done < until) {
    const fmi2Status status = one_step(*run, run->done);
    if (status >= fmi2Discard) return status;
    ++run->done;
  }
  return fmi2OK;
}
