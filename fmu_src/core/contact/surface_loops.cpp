#include "contact/surface_loops.hpp"

#include <algorithm>
#include <limits>

#include "machine/lanes.hpp"

namespace softffd::kernels {

namespace loops {

/// Sums and extremes are taken of so many numbers side by side.
constexpr int side_by_side = 8;

INNER void add_scaled(std::size_t n, double a, const double* x, double* __restrict y) {
  for (std::size_t i = 0; i < n; ++i) y[i] += a * x[i];
}

template <int n>
INNER void weighted_sums(int points, int rows, const double* f, const double* w, double* sums) {
  const auto at = [&]<int m>(int i, Register<m>) INLINED {
    Lanes<m> sum[3]{};
    for (int t = 0; t < rows; ++t) {
      const Lanes<m> weight = load<m>(w + std::ptrdiff_t(t) * points + i);
      for (int axis = 0; axis < 3; ++axis) sum[axis] += f[3 * t + axis] * weight;
    }
    for (int axis = 0; axis < 3; ++axis) store<m>(sums + axis * points + i, sum[axis]);
  };
  int i = 0;
  for (; i + n <= points; i += n) at(i, Register<n>{});
  for (; i < points; ++i) at(i, Register<1>{});
}

template <int n>
INNER Descent descent(std::size_t count, const double* before, const double* heights) {
  constexpr int registers = side_by_side / n;
  Lanes<n> least[registers], rise[registers], none[registers]{};
  for (int r = 0; r < registers; ++r) least[r] = rise[r] = std::numeric_limits<double>::infinity() + none[r];
  for (std::size_t i = 0; i < count; i += side_by_side)
    for (int r = 0; r < registers; ++r) {
      const std::size_t at = std::min(i, count - side_by_side) + r * n;  // the last ones overlap
      const Lanes<n> height = load<n>(heights + at), risen = height - load<n>(before + at);
      least[r] = height < least[r] ? height : least[r];
      rise[r] = risen < rise[r] ? risen : rise[r];
      none[r] += 0.0 * height;
    }
  Descent all{least[0][0], -rise[0][0]};
  double not_finite = 0;
  for (int r = 0; r < registers; ++r)
    for (int lane = 0; lane < n; ++lane) {
      all = {std::min(all.least, least[r][lane]), std::max(all.most, -rise[r][lane])};
      not_finite += none[r][lane];
    }
  return {all.least + not_finite, all.most + not_finite};
}

template <int n>
INNER double energy_taken(int points, const double* m0, double a, const double* u, const double* m1, const double* w, const double* v0,
                          const double* v1) {
  constexpr int registers = side_by_side / n;
  Lanes<n> sum[registers]{};
  double taken = 0;
  for (int axis = 0; axis < 3; ++axis, u += points, w += points, v0 += points, v1 += points) {
    const auto at = [&]<int m>(int i, Register<m>) INLINED {
      const Lanes<m> given = load<m>(m0 + i) * (a * load<m>(u + i)) + load<m>(m1 + i) * load<m>(w + i);
      return given * (0.5 * (load<m>(v0 + i) + load<m>(v1 + i)));
    };
    int i = 0;
    for (; i + side_by_side <= points; i += side_by_side)
      for (int r = 0; r < registers; ++r) sum[r] += at(i + r * n, Register<n>{});
    for (; i < points; ++i) taken -= at(i, Register<1>{})[0];
  }
  for (int r = 0; r < registers; ++r)
    for (int lane = 0; lane < n; ++lane) taken -= sum[r][lane];
  return taken;
}

}  // namespace loops

decltype(add_scaled) add_scaled = chosen<loops::add_scaled>();
decltype(weighted_sums) weighted_sums = chosen<loops::weighted_sums<2>, loops::weighted_sums<4>, loops::weighted_sums<8>>();
decltype(descent) descent = chosen<loops::descent<2>, loops::descent<4>, loops::descent<8>>();
decltype(energy_taken) energy_taken = chosen<loops::energy_taken<2>, loops::energy_taken<4>, loops::energy_taken<8>>();

}  // namespace softffd::kernels
