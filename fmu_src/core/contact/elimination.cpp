#include "contact/elimination.hpp"

#include <algorithm>
#include <cmath>

namespace softffd {

bool eliminate(int n, std::vector<double>& a, std::vector<double>& b) {
  for (int c = 0; c < n; ++c) {
    int pivot = c;
    for (int r = c + 1; r < n; ++r)
      if (std::abs(a[r * n + c]) > std::abs(a[pivot * n + c])) pivot = r;
    if (!(std::abs(a[pivot * n + c]) > 0)) return false;
    if (pivot != c) {
      std::swap_ranges(&a[c * n], &a[c * n] + n, &a[pivot * n]);
      std::swap(b[c], b[pivot]);
    }
    const double* top = &a[c * n];
    for (int r = c + 1; r < n; ++r) {
      double* row = &a[r * n];
      const double factor = row[c] / top[c];
      if (factor == 0) continue;
      for (int j = c + 1; j < n; ++j) row[j] -= factor * top[j];
      b[r] -= factor * b[c];
    }
  }
  for (int c = n - 1; c >= 0; --c) {
    for (int j = c + 1; j < n; ++j) b[c] -= a[c * n + j] * b[j];
    b[c] /= a[c * n + c];
  }
  return std::all_of(b.begin(), b.end(), [](double x) { return x - x == 0; });
}

}  // namespace softffd
