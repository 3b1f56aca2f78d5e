#include "contact/row_factor.hpp"

#include "machine/lanes.hpp"

namespace softffd {

namespace kernels {
namespace {

constexpr int together = RowFactor::together;

INNER void solve_together(int n, const double* factor, double* b) {
  const auto at = [b](int i) INLINED { return load<together>(b + together * i); };
  const double* row = factor;
  for (int i = 0; i < n; row += ++i) {
    Lanes<together> sum = at(i);
    for (int j = 0; j < i; ++j) sum -= row[j] * at(j);
    store<together>(b + together * i, sum / row[i]);
  }
  for (int i = n - 1; i >= 0; --i) {
    row -= i + 1;
    const Lanes<together> solved = at(i) / row[i];
    store<together>(b + together * i, solved);
    for (int j = 0; j < i; ++j) store<together>(b + together * j, at(j) - row[j] * solved);
  }
}

const auto solve_together_here = chosen<solve_together>();

}  // namespace
}  // namespace kernels

void RowFactor::solve_together(double* b) const { kernels::solve_together_here(size_, l_.data(), b); }

}  // namespace softffd
