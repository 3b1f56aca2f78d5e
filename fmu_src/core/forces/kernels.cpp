#include "forces/kernels.hpp"

#include <cmath>

#include "machine/lanes.hpp"

namespace softffd::kernels {

namespace loops {

INNER void add(int lanes, In sx, In sy, In sz, Out fx, Out fy, Out fz) {
  for (int p = 0; p < lanes; ++p) {
    fx[p] += sx[p];
    fy[p] += sy[p];
    fz[p] += sz[p];
  }
}

INNER void subtract(int lanes, In sx, In sy, In sz, Out fx, Out fy, Out fz) {
  for (int p = 0; p < lanes; ++p) {
    fx[p] -= sx[p];
    fy[p] -= sy[p];
    fz[p] -= sz[p];
  }
}

INNER void add_scaled(int lanes, In c, In s, Out f) {
  for (int p = 0; p < lanes; ++p) f[p] += c[p] * s[p];
}

INNER void bound(int lanes, In x0, In y0, In z0, In x1, In y1, In z1, In l, Out xx, Out yy, Out zz, Out xy, Out xz, Out yz) {
  for (int p = 0; p < lanes; ++p) {
    const double dx = x1[p] - x0[p], dy = y1[p] - y0[p], dz = z1[p] - z0[p];
    const double r2 = dx * dx + dy * dy + dz * dz + smallest_square;
    const double stretched = 1.0 - l[p] / std::sqrt(r2);
    const double e = stretched > 0.0 ? stretched : 0.0;
    const double c = (1.0 - e) / r2;
    xx[p] = c * dx * dx + e;
    yy[p] = c * dy * dy + e;
    zz[p] = c * dz * dz + e;
    xy[p] = c * dx * dy;
    xz[p] = c * dx * dz;
    yz[p] = c * dy * dz;
  }
}

INNER void add_stiffness_bounds(const SpringRow& springs, int points, const double* x, const double* first, const double* second, double* s,
                                double* bounds) {
  const int lanes = springs.lanes;
  const double *a = x + springs.begin, *b = a + springs.offset;
  const auto part = [&](int c) INLINED { return bounds + c * lanes; };
  bound(lanes, a, a + points, a + 2 * points, b, b + points, b + 2 * points, springs.rest_length, part(0), part(1), part(2), part(3),
        part(4), part(5));
  for (int c = 0; c < 6; ++c) {
    double* at_first = s + c * points + springs.begin;
    add_scaled(lanes, first, part(c), at_first);
    add_scaled(lanes, second, part(c), at_first + springs.offset);
  }
}

INNER void kick(std::size_t n, const double* a, const double* b, const double* f, const double* g, double* __restrict v) {
  for (std::size_t i = 0; i < n; ++i) v[i] = a[i] * v[i] + b[i] * (f[i] + g[i]);
}

INNER void kick_and_drift(std::size_t n, const double* a, const double* b, const double* f, const double* g, double h, const double* v,
                          const double* x, double* __restrict w, double* __restrict y) {
  for (std::size_t i = 0; i < n; ++i) {
    w[i] = a[i] * v[i] + b[i] * (f[i] + g[i]);
    y[i] = x[i] + h * w[i];
  }
}

INNER void drift(std::size_t n, double h, const double* x, const double* v, double* __restrict y) {
  for (std::size_t i = 0; i < n; ++i) y[i] = x[i] + h * v[i];
}

INNER void push(std::size_t n, double h, const double* m, const double* f, double* __restrict v) {
  for (std::size_t i = 0; i < n; ++i) v[i] += h * (m[i] * f[i]);
}

INNER void begin_kick(int points, const double* m, const double* d, const double* f, const double* g, const double* v, double s, Out a,
                      Out b) {
  for (int column = 0; column < 3 * points; column += points)
    for (int p = 0, i = column; p < points; ++p, ++i) {
      a[i] = (f[i] + g[i] - d[p] * v[i]) / m[p];
      b[i] = s * a[i];
    }
}

INNER void end_kick(std::size_t n, double h, const double* v0, const double* a, const double* b, double* __restrict v) {
  for (std::size_t i = 0; i < n; ++i) v[i] = v0[i] + h * (a[i] - b[i]);
}

INNER void scale(int points, const double* s, const double* x, double* y) {
  for (int column = 0; column < 3 * points; column += points)
    for (int p = 0; p < points; ++p) y[column + p] = s[p] * x[column + p];
}

INNER void accelerate(std::size_t n, const double* m, const double* f, const double* g, double* __restrict a) {
  for (std::size_t i = 0; i < n; ++i) a[i] = m[i] * (f[i] + g[i]);
}

INNER void accelerate_damped(std::size_t n, const double* m, const double* r, const double* f, const double* g, const double* v,
                             double* __restrict a) {
  for (std::size_t i = 0; i < n; ++i) a[i] = m[i] * (f[i] + g[i]) - r[i] * v[i];
}

/// Combines the numbers from i on that `registers` registers hold; the sums stay in registers while all arrays are added.
template <int n, int registers>
INNER void combine_some(std::size_t i, const double* x, int count, const double* w, const double* const* a, double* y) {
  Lanes<n> sum[registers];
  for (int k = 0; k < registers; ++k) sum[k] = load<n>(x + i + k * n);
  for (int j = 0; j < count; ++j)
    for (int k = 0; k < registers; ++k) sum[k] += w[j] * load<n>(a[j] + i + k * n);
  for (int k = 0; k < registers; ++k) store<n>(y + i + k * n, sum[k]);
}

template <int n>
INNER void combine(std::size_t numbers, const double* x, int count, const double* w, const double* const* a, double* y) {
  constexpr int registers = 4;
  std::size_t i = 0;
  for (; i + registers * n <= numbers; i += registers * n) combine_some<n, registers>(i, x, count, w, a, y);
  for (; i + n <= numbers; i += n) combine_some<n, 1>(i, x, count, w, a, y);
  for (; i < numbers; ++i) combine_some<1, 1>(i, x, count, w, a, y);
}

/// The largest size of numbers that are read several at a time; NaN if any is NaN or infinite. Comparisons do not show these, but their
/// product with 0 is NaN.
template <int n>
struct Largest {
  Lanes<n> most{}, none{};
  INLINED void see(const Lanes<n>& number) {
    const Lanes<n> size = number < 0.0 ? -number : number;
    most = size > most ? size : most;
    none += 0.0 * size;
  }
};

/// Returns the largest size of `count` numbers. read(i, register): the numbers from i on that a register holds.
template <int n, class Read>
INNER double largest_of(std::size_t count, const Read& read) {
  Largest<n> many;
  Largest<1> rest;
  std::size_t i = 0;
  for (; i + n <= count; i += n) many.see(read(i, Register<n>{}));
  for (; i < count; ++i) rest.see(read(i, Register<1>{}));
  double largest = rest.most[0], none = rest.none[0];
  for (int lane = 0; lane < n; ++lane) {
    largest = many.most[lane] > largest ? many.most[lane] : largest;
    none += many.none[lane];
  }
  return largest + none;
}

template <int n>
INNER double largest(std::size_t count, const double* x) {
  return largest_of<n>(count, [&]<int m>(std::size_t i, Register<m>) INLINED { return load<m>(x + i); });
}

template <int n>
INNER double largest_weighted(std::size_t count, const double* w, const double* x) {
  return largest_of<n>(count, [&]<int m>(std::size_t i, Register<m>) INLINED { return load<m>(w + i) * load<m>(x + i); });
}

template <int n>
INNER double largest_change(const SpringRow& springs, int points, const double* x, const double* y) {
  const std::ptrdiff_t offset = springs.offset;
  x += springs.begin, y += springs.begin;
  return largest_of<n>(std::size_t(springs.lanes), [&]<int m>(std::size_t i, Register<m>) INLINED {
    Lanes<m> square{};
    for (const double *a = x + i, *b = y + i; a < x + i + 3 * points; a += points, b += points) {
      const Lanes<m> change = (load<m>(a + offset) - load<m>(a)) - (load<m>(b + offset) - load<m>(b));
      square += change * change;
    }
    return load<m>(springs.stiffness + i) > 0.0 ? square : Lanes<m>{};
  });
}

INNER bool gaps(int points, const double* x, const double normal[3], double offset, double* __restrict gap) {
  const double nx = normal[0], ny = normal[1], nz = normal[2];
  const double* __restrict y = x + points, * __restrict z = y + points;
  int behind = 0;
  for (int p = 0; p < points; ++p) {
    gap[p] = nx * x[p] + ny * y[p] + nz * z[p] - offset;
    behind |= gap[p] < 0.0;
  }
  return behind != 0;
}

/// Returns one bit for each point at x that a register holds: whether the gap is negative.
template <int n>
INNER unsigned behind_some(int points, const double* x, const double normal[3], double offset) {
  const Triple<n> at = load<n>(x, points);
  return bits<n>(normal[0] * at.x + normal[1] * at.y + normal[2] * at.z - offset < 0.0);
}

template <int n>
INNER bool behind(int points, const double* x, const double plane_normal[3], double offset, unsigned char* found) {
  const double normal[3] = {plane_normal[0], plane_normal[1], plane_normal[2]};  // a copy that no writing to `found` changes
  unsigned any = 0;
  int p = 0;
  for (; p + 8 <= points; p += 8) {
    unsigned block = 0;
    for (int lane = 0; lane < 8; lane += n) block |= behind_some<n>(points, x + p + lane, normal, offset) << lane;
    *found++ = static_cast<unsigned char>(block);
    any |= block;
  }
  unsigned block = 0;
  for (int lane = 0; p + lane < points; ++lane) block |= behind_some<1>(points, x + p + lane, normal, offset) << lane;
  if (p < points) *found = static_cast<unsigned char>(block);
  return (any | block) != 0;
}

/// Adds the springs' forces, which are in `scratch`, to f at their first ends and subtracts them at their second ends.
INNER void give_both_ends(const SpringRow& springs, int points, const double* scratch, double* f) {
  const int lanes = springs.lanes;
  const double *sx = scratch, *sy = scratch + lanes, *sz = scratch + 2 * lanes;
  double *first = f + springs.begin, *second = first + springs.offset;
  add(lanes, sx, sy, sz, first, first + points, first + 2 * points);
  subtract(lanes, sx, sy, sz, second, second + points, second + 2 * points);
}

/// A smaller 1 - l/r counts as this value [1], which keeps the matrix of a spring without length finite.
constexpr double least_stretch = -1e6;

INNER void spring_matrices(int lanes, double softening, double per_time, In x0, In y0, In z0, In x1, In y1, In z1, In k, In l, In dashpot,
                           Out xx, Out yy, Out zz, Out xy, Out xz, Out yz) {
  for (int p = 0; p < lanes; ++p) {
    const double dx = x1[p] - x0[p], dy = y1[p] - y0[p], dz = z1[p] - z0[p];
    const double r2 = dx * dx + dy * dy + dz * dz + smallest_square;
    const double stretched = 1.0 - l[p] / std::sqrt(r2), finite = stretched > least_stretch ? stretched : least_stretch;
    const double e = finite > 0 ? finite : softening * finite;
    const double c = (k[p] * (1.0 - e) + per_time * dashpot[p]) / r2, ke = k[p] * e;
    xx[p] = c * dx * dx + ke;
    yy[p] = c * dy * dy + ke;
    zz[p] = c * dz * dz + ke;
    xy[p] = c * dx * dy;
    xz[p] = c * dx * dz;
    yz[p] = c * dy * dz;
  }
}

INNER void add_spring_matrices(const SpringRow& springs, const double* dashpot, int points, const double* x, double softening,
                               double per_time, double* block, double* sums) {
  const int lanes = springs.lanes;
  const double *a = x + springs.begin, *b = a + springs.offset;
  spring_matrices(lanes, softening, per_time, a, a + points, a + 2 * points, b, b + points, b + 2 * points, springs.stiffness,
                  springs.rest_length, dashpot, block, block + lanes, block + 2 * lanes, block + 3 * lanes, block + 4 * lanes,
                  block + 5 * lanes);
  for (int c = 0; c < 6; c += 3)
    for (int offset : {0, springs.offset}) {
      const double* three = block + c * lanes;
      double* sum = sums + c * points + springs.begin + offset;
      add(lanes, three, three + lanes, three + 2 * lanes, sum, sum + points, sum + 2 * points);
    }
}

INNER void spring_products(int lanes, double softening, double per_time, In x0, In y0, In z0, In x1, In y1, In z1, In u0, In v0, In w0,
                           In u1, In v1, In w1, In k, In l, In dashpot, Out sx, Out sy, Out sz) {
  for (int p = 0; p < lanes; ++p) {
    const double dx = x1[p] - x0[p], dy = y1[p] - y0[p], dz = z1[p] - z0[p];
    const double ux = u1[p] - u0[p], uy = v1[p] - v0[p], uz = w1[p] - w0[p];
    const double r2 = dx * dx + dy * dy + dz * dz + smallest_square;
    const double stretched = 1.0 - l[p] / std::sqrt(r2), finite = stretched > least_stretch ? stretched : least_stretch;
    const double e = finite > 0 ? finite : softening * finite, ke = k[p] * e;
    const double along = (k[p] * (1.0 - e) + per_time * dashpot[p]) * ((dx * ux + dy * uy + dz * uz) / r2);
    sx[p] = along * dx + ke * ux;
    sy[p] = along * dy + ke * uy;
    sz[p] = along * dz + ke * uz;
  }
}

INNER void subtract_spring_products(const SpringRow& springs, const double* dashpot, int points, const double* x, double softening,
                                    double per_time, const double* u, double* f, double* scratch) {
  const int lanes = springs.lanes, offset = springs.offset;
  const double *a = x + springs.begin, *b = a + offset, *ua = u + springs.begin, *ub = ua + offset;
  spring_products(lanes, softening, per_time, a, a + points, a + 2 * points, b, b + points, b + 2 * points, ua, ua + points,
                  ua + 2 * points, ub, ub + points, ub + 2 * points, springs.stiffness, springs.rest_length, dashpot, scratch,
                  scratch + lanes, scratch + 2 * lanes);
  give_both_ends(springs, points, scratch, f);
}

}  // namespace loops

decltype(add_stiffness_bounds) add_stiffness_bounds = chosen<loops::add_stiffness_bounds>();
decltype(kick) kick = chosen<loops::kick>();
decltype(kick_and_drift) kick_and_drift = chosen<loops::kick_and_drift>();
decltype(drift) drift = chosen<loops::drift>();
decltype(push) push = chosen<loops::push>();
decltype(begin_kick) begin_kick = chosen<loops::begin_kick>();
decltype(end_kick) end_kick = chosen<loops::end_kick>();
decltype(scale) scale = chosen<loops::scale>();
decltype(accelerate) accelerate = chosen<loops::accelerate>();
decltype(accelerate_damped) accelerate_damped = chosen<loops::accelerate_damped>();
decltype(combine) combine = chosen<loops::combine<2>, loops::combine<4>, loops::combine<8>>();
decltype(largest) largest = chosen<loops::largest<2>, loops::largest<4>, loops::largest<8>>();
decltype(largest_weighted) largest_weighted = chosen<loops::largest_weighted<2>, loops::largest_weighted<4>, loops::largest_weighted<8>>();
decltype(gaps) gaps = chosen<loops::gaps>();
decltype(behind) behind = chosen<loops::behind<2>, loops::behind<4>, loops::behind<8>>();
decltype(largest_change) largest_change = chosen<loops::largest_change<2>, loops::largest_change<4>, loops::largest_change<8>>();
decltype(add_spring_matrices) add_spring_matrices = chosen<loops::add_spring_matrices>();
decltype(subtract_spring_products) subtract_spring_products = chosen<loops::subtract_spring_products>();

}  // namespace softffd::kernels
