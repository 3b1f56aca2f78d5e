#include "contact/surface/surface_loops.hpp"

#include <algorithm>
#include <limits>
#include <type_traits>

#include "machine/lanes.hpp"

namespace softffd::kernels {

namespace loops {

/// Number of sums or extremes that are taken side by side.
constexpr int side_by_side = 8;

template <int n>
INNER Lanes<n / 2> halved(const Lanes<n>& of) {
  Lanes<n / 2> half[2];
  std::memcpy(half, &of, sizeof half);
  return half[0] + half[1];
}

/// Returns the sum of the lanes of registers that hold eight numbers together, in the same order for any register width.
template <int n>
INNER double total(const Lanes<n>* of) {
  Lanes<2> two;
  if constexpr (n == 8)
    two = halved<4>(halved<8>(of[0]));
  else if constexpr (n == 4)
    two = halved<4>(of[0] + of[1]);
  else
    two = (of[0] + of[2]) + (of[1] + of[3]);
  return two[0] + two[1];
}

/// Calls act(i, register) for the points of a range, as many at a time as a register holds.
template <int n, class Act>
INNER void each_register(PointRange range, const Act& act) {
  int i = range.begin;
  for (; i + n <= range.end; i += n) act(i, Register<n>{});
  for (; i < range.end; ++i) act(i, Register<1>{});
}

template <int n>
INNER void weighted_sums(int points, PointRange range, int rows, const double* f, const double* w, double* sums) {
  each_register<n>(range, [&]<int m>(int i, Register<m>) INLINED {
    Lanes<m> sum[3]{};
    for (int t = 0; t < rows; ++t) {
      const Lanes<m> weight = load<m>(w + std::ptrdiff_t(t) * points + i);
      for (int axis = 0; axis < 3; ++axis) sum[axis] += f[3 * t + axis] * weight;
    }
    for (int axis = 0; axis < 3; ++axis) store<m>(sums + axis * points + i, sum[axis]);
  });
}

/// Computes the sums of `some` rows at a time, which reads the values of the points once: eight partial sums side by side, then their
/// total.
template <int n, int columns, int some>
INNER void some_row_sums(int points, PointRange range, const double* w, const double* x, double* sums) {
  constexpr int registers = side_by_side / n;
  Lanes<n> sum[some * columns][registers]{};
  int i = range.begin;
  for (; i + side_by_side <= range.end; i += side_by_side)
    for (int r = 0; r < registers; ++r) {
      Lanes<n> value[columns];
      for (int c = 0; c < columns; ++c) value[c] = load<n>(x + c * points + i + r * n);
      for (int t = 0; t < some; ++t) {
        const Lanes<n> weight = load<n>(w + std::ptrdiff_t(t) * points + i + r * n);
        for (int c = 0; c < columns; ++c) sum[t * columns + c][r] += weight * value[c];
      }
    }
  for (int s = 0; s < some * columns; ++s) sums[s] = total<n>(sum[s]);
  for (; i < range.end; ++i)
    for (int t = 0; t < some; ++t)
      for (int c = 0; c < columns; ++c) sums[t * columns + c] += w[std::ptrdiff_t(t) * points + i] * x[c * points + i];
}

template <int n, int columns>
INNER void row_sums(int points, PointRange range, int rows, const double* w, const double* x, double* sums) {
  constexpr int some = n == 8 ? 4 : n == 4 ? 2 : 1;  // as many rows as the registers hold
  const auto next = [&]<int count>(std::integral_constant<int, count>) INLINED {
    some_row_sums<n, columns, count>(points, range, w, x, sums);
    w += std::ptrdiff_t(count) * points, sums += count * columns, rows -= count;
  };
  while (rows >= some) next(std::integral_constant<int, some>{});
  if (some > 3 && rows == 3) return next(std::integral_constant<int, 3>{});
  if (some > 2 && rows == 2) return next(std::integral_constant<int, 2>{});
  if (some > 1 && rows == 1) next(std::integral_constant<int, 1>{});
}

template <int n>
INNER void add_motion(int points, PointRange range, const double normal[3], const double* move, double* gaps) {
  const double nx = normal[0], ny = normal[1], nz = normal[2];
  each_register<n>(range, [&]<int m>(int i, Register<m>) INLINED {
    const Triple<m> by = load<m>(move + i, points);
    store<m>(gaps + i, load<m>(gaps + i) + (nx * by.x + ny * by.y + nz * by.z));
  });
}

template <int n>
INNER void move_points(int points, PointRange range, const double* move, double a, double* v, double* x) {
  each_register<n>(range, [&]<int m>(int from, Register<m>) INLINED {
    for (int i = from; i < 3 * points; i += points) {
      const Lanes<m> by = load<m>(move + i);
      store<m>(v + i, load<m>(v + i) + a * by);
      if (x) store<m>(x + i, load<m>(x + i) + by);
    }
  });
}

template <int n>
INNER double speeds(int points, const double normal[3], const double* v, double* speeds) {
  const double nx = normal[0], ny = normal[1], nz = normal[2];
  Lanes<n> most{}, none{};
  double largest = 0, not_finite = 0;
  each_register<n>({0, points}, [&]<int m>(int i, Register<m>) INLINED {
    const Triple<m> each = load<m>(v + i, points);
    const Lanes<m> square = each.x * each.x + each.y * each.y + each.z * each.z;
    store<m>(speeds + i, nx * each.x + ny * each.y + nz * each.z);
    if constexpr (m == n) {
      most = square > most ? square : most;
      none += 0.0 * square;
    } else {
      largest = std::max(largest, square[0]);
      not_finite += 0.0 * square[0];
    }
  });
  for (int lane = 0; lane < n; ++lane) {
    largest = std::max(largest, most[lane]);
    not_finite += none[lane];
  }
  return largest + not_finite;
}

template <int n>
INNER Descent descent(std::size_t count, const double* before, const double* gaps) {
  constexpr int registers = side_by_side / n;
  Lanes<n> least[registers], rise[registers], none[registers]{};
  for (int r = 0; r < registers; ++r) least[r] = rise[r] = std::numeric_limits<double>::infinity() + none[r];
  for (std::size_t i = 0; i < count; i += side_by_side)
    for (int r = 0; r < registers; ++r) {
      const std::size_t at = std::min(i, count - side_by_side) + r * n;  // the last block overlaps the one before it
      const Lanes<n> height = load<n>(gaps + at), risen = height - load<n>(before + at);
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
INNER double energy_taken(int points, PointRange range, const double* m0, double a, const double* u, const double* m1, const double* w,
                          const double* v0, const double* v1) {
  constexpr int registers = side_by_side / n;
  Lanes<n> sum[registers]{};
  double taken = 0;
  for (int axis = 0; axis < 3; ++axis, u += points, w += points, v0 += points, v1 += points) {
    const auto at = [&]<int m>(int i, Register<m>) INLINED {
      const Lanes<m> given = load<m>(m0 + i) * (a * load<m>(u + i)) + load<m>(m1 + i) * load<m>(w + i);
      return given * (0.5 * (load<m>(v0 + i) + load<m>(v1 + i)));
    };
    int i = range.begin;
    for (; i + side_by_side <= range.end; i += side_by_side)
      for (int r = 0; r < registers; ++r) sum[r] += at(i + r * n, Register<n>{});
    for (; i < range.end; ++i) taken -= at(i, Register<1>{})[0];
  }
  for (int r = 0; r < registers; ++r)
    for (int lane = 0; lane < n; ++lane) taken -= sum[r][lane];
  return taken;
}

}  // namespace loops

decltype(weighted_sums) weighted_sums = chosen<loops::weighted_sums<2>, loops::weighted_sums<4>, loops::weighted_sums<8>>();
decltype(row_places) row_places = chosen<loops::row_sums<2, 3>, loops::row_sums<4, 3>, loops::row_sums<8, 3>>();
decltype(row_values) row_values = chosen<loops::row_sums<2, 1>, loops::row_sums<4, 1>, loops::row_sums<8, 1>>();
decltype(add_motion) add_motion = chosen<loops::add_motion<2>, loops::add_motion<4>, loops::add_motion<8>>();
decltype(move_points) move_points = chosen<loops::move_points<2>, loops::move_points<4>, loops::move_points<8>>();
decltype(speeds) speeds = chosen<loops::speeds<2>, loops::speeds<4>, loops::speeds<8>>();
decltype(descent) descent = chosen<loops::descent<2>, loops::descent<4>, loops::descent<8>>();
decltype(energy_taken) energy_taken = chosen<loops::energy_taken<2>, loops::energy_taken<4>, loops::energy_taken<8>>();

}  // namespace softffd::kernels
