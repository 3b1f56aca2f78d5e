#include "contact/elimination.hpp"

#include <algorithm>
#include <cmath>

#include "machine/instructions.hpp"

namespace softffd {

namespace kernels {
namespace {

INNER void subtract(int n, double factor, In top, Out row) {
  for (int j = 0; j < n; ++j) row[j] -= factor * top[j];
}

INNER bool eliminate(int n, double* a, double* b) {
  for (int c = 0; c < n; ++c) {
    int pivot = c;
    for (int r = c + 1; r < n; ++r)
      if (std::abs(a[r * n + c]) > std::abs(a[pivot * n + c])) pivot = r;
    if (!(std::abs(a[pivot * n + c]) > 0)) return false;
    if (pivot != c) {
      for (int j = c; j < n; ++j) std::swap(a[c * n + j], a[pivot * n + j]);
      std::swap(b[c], b[pivot]);
    }
    for (int r = c + 1; r < n; ++r) {
      const double factor = a[r * n + c] / a[c * n + c];
      if (factor == 0) continue;
      subtract(n - c - 1, factor, &a[c * n + c + 1], &a[r * n + c + 1]);
      b[r] -= factor * b[c];
    }
  }
  for (int c = n - 1; c >= 0; --c) {
    for (int j = c + 1; j < n; ++j) b[c] -= a[c * n + j] * b[j];
    b[c] /= a[c * n + c];
  }
  return true;
}

const auto eliminate_here = chosen<eliminate>();

}  // namespace
}  // namespace kernels

bool eliminate(int n, std::vector<double>& a, std::vector<double>& b) {
  return kernels::eliminate_here(n, a.data(), b.data()) && std::all_of(b.begin(), b.end(), [](double x) { return x - x == 0; });
}

}  // namespace softffd
