#include "embedding/bounds.hpp"

#include <limits>

#include "machine/lanes.hpp"

namespace {

using namespace softffd::kernels;

/// n points fill three registers, whose lanes are x, y and z in turn.
template <int n>
INNER void bounds(long long count, const double* points, double* low, double* high) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Lanes<n> least[3], most[3];
  Comparison<n> none[3] = {};
  for (int r = 0; r < 3; ++r) least[r] = Lanes<n>{} + infinity, most[r] = Lanes<n>{} - infinity;
  long long at = 0;
  for (; at + n <= count; at += n, points += 3 * n)
    for (int r = 0; r < 3; ++r) {
      const Lanes<n> x = load<n>(points + r * n);
      least[r] = x < least[r] ? x : least[r];
      most[r] = x > most[r] ? x : most[r];
      none[r] |= x != x;
    }
  for (int a = 0; a < 3; ++a) low[a] = infinity, high[a] = -infinity;
  const auto take = [&](int a, double smallest, double largest, bool number) {
    low[a] = !number || low[a] != low[a] ? std::numeric_limits<double>::quiet_NaN() : smallest < low[a] ? smallest : low[a];
    high[a] = low[a] != low[a] ? low[a] : largest > high[a] ? largest : high[a];
  };
  for (int p = 0; p < 3 * n; ++p) take(p % 3, least[p / n][p % n], most[p / n][p % n], none[p / n][p % n] == 0);
  for (; at < count; ++at, points += 3)
    for (int a = 0; a < 3; ++a) take(a, points[a], points[a], points[a] == points[a]);
}

const auto bounds_here = chosen<bounds<2>, bounds<4>, bounds<8>>();

}  // namespace

void softffd_bounds(long long count, const double* points, double* low, double* high) { bounds_here(count, points, low, high); }
