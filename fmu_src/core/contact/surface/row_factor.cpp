#include "contact/surface/row_factor.hpp"

#include "machine/lanes.hpp"

namespace softffd {

namespace kernels {
namespace {

constexpr int together = RowFactor::together;

/// Each sum reads the results that the sums before it have stored. The parts of the sums that do not wait for the last result overlap.
INNER void solve_together(int n, const double* factor, const double* inverse, double* b) {
  const auto at = [b](int i) INLINED { return load<together>(b + together * i); };
  const double* row = factor;
  for (int i = 0; i < n; row += ++i) {
    Lanes<together> sum = at(i);
    for (int j = 0; j < i; ++j) sum -= row[j] * at(j);
    store<together>(b + together * i, sum * inverse[i]);
  }
  for (int i = n - 1; i >= 0; --i) {
    Lanes<together> sum = at(i);
    const double* column = row - n + i;  // begins in the last row and goes upwards
    for (int j = n - 1; j > i; column -= j--) sum -= *column * at(j);
    store<together>(b + together * i, sum * inverse[i]);
  }
}

const auto solve_together_here = chosen<solve_together>();

}  // namespace
}  // namespace kernels

void RowFactor::solve_together(double* b) const { kernels::solve_together_here(size_, l_.data(), inverse_.data(), b); }

}  // namespace softffd
