/// Derivatives of outputs: the part of Variables that compares successive communication points.
#include <algorithm>
#include <cmath>
#include <limits>

#include "variables/variables.hpp"

namespace softffd::fmi {

void Variables::get_output_derivatives(const fmi2ValueReference* references, std::size_t count, const fmi2Integer* orders, double* numbers,
                                       SoftBody& body, const ErrorEstimate* estimate) {
  for (std::size_t n = 0; n < count; ++n) {
    if (checked(references[n], Type::Real).info().causality != Causality::output)
      throw CallError(name(references[n]) + ": is no output, it has no output derivative");
    if (orders[n] != 1) throw CallError(name(references[n]) + ": wanted a derivative of order 1, got " + std::to_string(orders[n]));
  }
  const Observed observed{probes_, places_, followed_, body, estimate};
  for (std::size_t n = 0; n < count; ++n) {
    const Variable variable = *find(references[n]);
    if (const Binding::Output rate = bindings[variable.row].rate_output)
      numbers[n] = rate(observed, member(variable), variable.component());
    else
      numbers[n] = last_.length > 0 ? (read(variable, observed) - last_.before[variable.row][variable.index]) / last_.length : 0;
  }
}

/// Returns an output. Outputs that the next step needs too are read once: an energy costs as much as the spring forces, a stable step more.
double Variables::read(const Variable& variable, const Observed& observed) {
  const Binding& binding = bindings[variable.row];
  const auto now = [&] {
    if (binding.field) return binding.field(observed.body)(member(variable), variable.component());
    return binding.output(observed, member(variable), variable.component());
  };
  if (!differenced(variable.row)) return now();
  double& seen = seen_[variable.row][variable.index];
  if (std::isnan(seen)) seen = now();
  return seen;
}

void Variables::forget_seen() {
  for (const std::size_t row : differenced_) std::fill(seen_[row].begin(), seen_[row].end(), std::numeric_limits<double>::quiet_NaN());
}

void Variables::begin_step(SoftBody& body, const ErrorEstimate* estimate) {
  const Observed observed{probes_, places_, followed_, body, estimate};
  for (const std::size_t row : differenced_)
    for (std::size_t index = 0; index < begun_[row].size(); ++index) begun_[row][index] = read(variable(row, int(index)), observed);
}

void Variables::end_step(double length) {
  for (const std::size_t row : differenced_) last_.before[row].swap(begun_[row]);
  last_.length = length;
  forget_seen();
}

}  // namespace softffd::fmi
