#include "forces/kernels.hpp"

#include <cmath>

#include "forces/clones.hpp"

namespace softffd::kernels {

// Keeps r = 0 finite: l / 1e-140 times a zero vector is a zero force.
#define SMALLEST_SQUARE 1e-280

INNER void forces(int lanes, In x0, In y0, In z0, In x1, In y1, In z1, In k, In l, Out sx, Out sy, Out sz) {
  for (int p = 0; p < lanes; ++p) {
    const double dx = x1[p] - x0[p], dy = y1[p] - y0[p], dz = z1[p] - z0[p];
    const double r = std::sqrt(dx * dx + dy * dy + dz * dz + SMALLEST_SQUARE);
    const double s = k[p] * (1.0 - l[p] / r);
    sx[p] = s * dx;
    sy[p] = s * dy;
    sz[p] = s * dz;
  }
}

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

INNER void bounds(int lanes, In x0, In y0, In z0, In x1, In y1, In z1, In l, Out xx, Out yy, Out zz, Out xy, Out xz, Out yz) {
  for (int p = 0; p < lanes; ++p) {
    const double dx = x1[p] - x0[p], dy = y1[p] - y0[p], dz = z1[p] - z0[p];
    const double r2 = dx * dx + dy * dy + dz * dz + SMALLEST_SQUARE;
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

INNER void add_square(int lanes, In a0, In a1, In b0, In b1, In k, Out square) {
  for (int p = 0; p < lanes; ++p) {
    const double change = (a1[p] - a0[p]) - (b1[p] - b0[p]);
    square[p] += k[p] > 0.0 ? change * change : 0.0;
  }
}

SOFTFFD_CLONES
void add_spring_forces(const SpringRow& springs, int points, const double* x, double* f, double* scratch) {
  const int lanes = springs.lanes;
  const double *a = x + springs.begin, *b = a + springs.offset;
  double *sx = scratch, *sy = scratch + lanes, *sz = scratch + 2 * lanes;
  forces(lanes, a, a + points, a + 2 * points, b, b + points, b + 2 * points, springs.stiffness, springs.rest_length, sx, sy, sz);
  double *first = f + springs.begin, *second = first + springs.offset;
  add(lanes, sx, sy, sz, first, first + points, first + 2 * points);
  subtract(lanes, sx, sy, sz, second, second + points, second + 2 * points);
}

SOFTFFD_CLONES
void add_stiffness_bounds(const SpringRow& springs, int points, const double* x, const double* first, const double* second, double* s,
                          double* scratch) {
  const int lanes = springs.lanes;
  const double *a = x + springs.begin, *b = a + springs.offset;
  const auto part = [&](int c) __attribute__((always_inline)) { return scratch + c * lanes; };
  bounds(lanes, a, a + points, a + 2 * points, b, b + points, b + 2 * points, springs.rest_length, part(0), part(1), part(2), part(3),
         part(4), part(5));
  for (int c = 0; c < 6; ++c) {
    double* at_first = s + c * points + springs.begin;
    add_scaled(lanes, first, part(c), at_first);
    add_scaled(lanes, second, part(c), at_first + springs.offset);
  }
}

SOFTFFD_CLONES
void kick(std::size_t n, const double* a, const double* b, const double* f, const double* g, double* __restrict v) {
  for (std::size_t i = 0; i < n; ++i) v[i] = a[i] * v[i] + b[i] * (f[i] + g[i]);
}

SOFTFFD_CLONES
void kick_undamped(std::size_t n, const double* b, const double* f, const double* g, double* __restrict v) {
  for (std::size_t i = 0; i < n; ++i) v[i] = v[i] + b[i] * (f[i] + g[i]);
}

SOFTFFD_CLONES
void drift(std::size_t n, double h, const double* x, const double* v, double* __restrict y) {
  for (std::size_t i = 0; i < n; ++i) y[i] = x[i] + h * v[i];
}

SOFTFFD_CLONES
void accelerate(std::size_t n, const double* m, const double* f, const double* g, double* __restrict a) {
  for (std::size_t i = 0; i < n; ++i) a[i] = m[i] * (f[i] + g[i]);
}

SOFTFFD_CLONES
void accelerate_damped(std::size_t n, const double* m, const double* r, const double* f, const double* g, const double* v,
                       double* __restrict a) {
  for (std::size_t i = 0; i < n; ++i) a[i] = m[i] * (f[i] + g[i]) - r[i] * v[i];
}

// A stretch of the result stays in registers or the nearest cache while all arrays are added to it.
constexpr std::size_t stretch = 64;

INNER void add_weighted(std::size_t n, double w, In a, Out y) {
  for (std::size_t i = 0; i < n; ++i) y[i] += w * a[i];
}

SOFTFFD_CLONES
void combine(std::size_t n, const double* x, int count, const double* w, const double* const* a, double* __restrict y) {
  for (std::size_t begin = 0; begin < n; begin += stretch) {
    const std::size_t size = n - begin < stretch ? n - begin : stretch;
    for (std::size_t i = 0; i < size; ++i) y[begin + i] = x[begin + i];
    for (int j = 0; j < count; ++j) add_weighted(size, w[j], a[j] + begin, y + begin);
  }
}

SOFTFFD_CLONES
double largest(std::size_t n, const double* x) {
  double largest = 0.0, sum = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double size = std::abs(x[i]);
    largest = size > largest ? size : largest;
    sum += 0.0 * size;  // NaN and infinity do not compare
  }
  return largest + sum;
}

SOFTFFD_CLONES
double largest_weighted(std::size_t n, const double* w, const double* x) {
  double largest = 0.0, sum = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double size = std::abs(w[i] * x[i]);
    largest = size > largest ? size : largest;
    sum += 0.0 * size;
  }
  return largest + sum;
}

SOFTFFD_CLONES
bool gaps(int points, const double* x, const double normal[3], double offset, double* __restrict gap) {
  const double nx = normal[0], ny = normal[1], nz = normal[2];
  const double* __restrict y = x + points, * __restrict z = y + points;
  int behind = 0;
  for (int p = 0; p < points; ++p) {
    gap[p] = nx * x[p] + ny * y[p] + nz * z[p] - offset;
    behind |= gap[p] < 0.0;
  }
  return behind != 0;
}

SOFTFFD_CLONES
double largest_change(const SpringRow& springs, int points, const double* x, const double* y, double* scratch) {
  const int lanes = springs.lanes, offset = springs.offset;
  for (int p = 0; p < lanes; ++p) scratch[p] = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double *a = x + axis * points + springs.begin, *b = y + axis * points + springs.begin;
    add_square(lanes, a, a + offset, b, b + offset, springs.stiffness, scratch);
  }
  double largest = 0.0;
  for (int p = 0; p < lanes; ++p) largest = scratch[p] > largest ? scratch[p] : largest;
  return largest;
}

INNER void stiffness_products(int lanes, In x0, In y0, In z0, In x1, In y1, In z1, In u0, In v0, In w0, In u1, In v1, In w1, In k, In l,
                              Out sx, Out sy, Out sz) {
  for (int p = 0; p < lanes; ++p) {
    const double dx = x1[p] - x0[p], dy = y1[p] - y0[p], dz = z1[p] - z0[p];
    const double ux = u1[p] - u0[p], uy = v1[p] - v0[p], uz = w1[p] - w0[p];
    const double r2 = dx * dx + dy * dy + dz * dz + SMALLEST_SQUARE;
    const double stretched = 1.0 - l[p] / std::sqrt(r2);
    const double e = stretched > 0.0 ? stretched : 0.0;
    const double along = (1.0 - e) * ((dx * ux + dy * uy + dz * uz) / r2);
    sx[p] = k[p] * (along * dx + e * ux);
    sy[p] = k[p] * (along * dy + e * uy);
    sz[p] = k[p] * (along * dz + e * uz);
  }
}

SOFTFFD_CLONES
void subtract_stiffness_product(const SpringRow& springs, int points, const double* x, const double* u, double* f, double* scratch) {
  const int lanes = springs.lanes, offset = springs.offset;
  const double *a = x + springs.begin, *b = a + offset, *ua = u + springs.begin, *ub = ua + offset;
  double *sx = scratch, *sy = scratch + lanes, *sz = scratch + 2 * lanes;
  stiffness_products(lanes, a, a + points, a + 2 * points, b, b + points, b + 2 * points, ua, ua + points, ua + 2 * points, ub, ub + points,
                     ub + 2 * points, springs.stiffness, springs.rest_length, sx, sy, sz);
  double *first = f + springs.begin, *second = first + offset;
  add(lanes, sx, sy, sz, first, first + points, first + 2 * points);
  subtract(lanes, sx, sy, sz, second, second + points, second + 2 * points);
}

/// Two columns c -= four columns a times the values at s, s + stride, ...: few enough to stay in registers.
INNER void subtract_four(int n, std::size_t stride, const double* a, const double* s, Out c0, Out c1) {
  In a0 = a, a1 = a + stride, a2 = a + 2 * stride, a3 = a + 3 * stride;
  const double p0 = s[0], p1 = s[stride], p2 = s[2 * stride], p3 = s[3 * stride];
  const double q0 = s[1], q1 = s[stride + 1], q2 = s[2 * stride + 1], q3 = s[3 * stride + 1];
  for (int i = 0; i < n; ++i) {
    c0[i] -= (a0[i] * p0 + a1[i] * p1) + (a2[i] * p2 + a3[i] * p3);
    c1[i] -= (a0[i] * q0 + a1[i] * q1) + (a2[i] * q2 + a3[i] * q3);
  }
}

SOFTFFD_CLONES
void subtract_products(int blocks, int count, std::size_t stride, const double* a, double* c) {
  const int n = block * blocks;
  for (int k = 0; k < count; k += 4, a += 4 * stride)
    for (int j = 0; j < block; j += 2) subtract_four(n, stride, a, a + j, c + j * stride, c + (j + 1) * stride);
}

/// Multiplies four columns by the inverse of the factor of their diagonal block from the right.
INNER void divide_four(int n, const double l[4][4], const double inverse[4], Out c0, Out c1, Out c2, Out c3) {
  const double l10 = l[1][0], l20 = l[2][0], l21 = l[2][1], l30 = l[3][0], l31 = l[3][1], l32 = l[3][2];
  const double i0 = inverse[0], i1 = inverse[1], i2 = inverse[2], i3 = inverse[3];
  for (int i = 0; i < n; ++i) {
    const double x0 = c0[i] * i0, x1 = (c1[i] - x0 * l10) * i1, x2 = (c2[i] - (x0 * l20 + x1 * l21)) * i2;
    c0[i] = x0;
    c1[i] = x1;
    c2[i] = x2;
    c3[i] = (c3[i] - (x0 * l30 + x1 * l31 + x2 * l32)) * i3;
  }
}

INNER void factor_four(int n, std::size_t stride, int diagonal, double* c, double* inverse) {
  double l[4][4];
  for (int j = 0; j < 4; ++j)
    for (int i = j; i < 4; ++i) {
      double sum = c[j * stride + diagonal + i];
      for (int k = 0; k < j; ++k) sum -= l[i][k] * l[j][k];
      if (i == j) inverse[j] = 1.0 / std::sqrt(sum);
      l[i][j] = sum * inverse[j];
    }
  divide_four(n, l, inverse, c, c + stride, c + 2 * stride, c + 3 * stride);
}

SOFTFFD_CLONES
void factor_panel(int blocks, std::size_t stride, double* c, double* inverse) {
  const int n = block * blocks;
  double* second = c + 4 * stride;
  factor_four(n, stride, 0, c, inverse);
  for (int j = 0; j < 4; j += 2) subtract_four(n, stride, c, c + 4 + j, second + j * stride, second + (j + 1) * stride);
  factor_four(n, stride, 4, second, inverse + 4);
}

INNER void subtract_eight(int n, std::size_t stride, const double* a, const double s[8], Out y) {
  In a0 = a, a1 = a + stride, a2 = a + 2 * stride, a3 = a + 3 * stride;
  In a4 = a + 4 * stride, a5 = a + 5 * stride, a6 = a + 6 * stride, a7 = a + 7 * stride;
  const double s0 = s[0], s1 = s[1], s2 = s[2], s3 = s[3], s4 = s[4], s5 = s[5], s6 = s[6], s7 = s[7];
  for (int i = 0; i < n; ++i)
    y[i] -= ((a0[i] * s0 + a1[i] * s1) + (a2[i] * s2 + a3[i] * s3)) + ((a4[i] * s4 + a5[i] * s5) + (a6[i] * s6 + a7[i] * s7));
}

SOFTFFD_CLONES
void solve_lower(int columns, int rows, std::size_t stride, const double* l, const double* inverse, double* y) {
  for (int j = 0; j < columns; j += block) {
    const double* panel = l + j * stride + j;
    double s[block];
    for (int i = 0; i < block; ++i) s[i] = y[j + i];
    for (int k = 0; k < block; ++k) {
      s[k] *= inverse[j + k];
      for (int i = k + 1; i < block; ++i) s[i] -= panel[k * stride + i] * s[k];
    }
    for (int i = 0; i < block; ++i) y[j + i] = s[i];
    subtract_eight((rows - j) / block * block - block, stride, panel + block, s, y + j + block);
  }
}

/// Products of four columns with y, in eight partial sums each whatever the vector width.
INNER void multiply_four(int blocks, std::size_t stride, const double* l, In y, double sums[4]) {
  double parts[4][block] = {};
  for (int b = 0; b < blocks; ++b)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < block; ++i) parts[j][i] += l[j * stride + b * block + i] * y[b * block + i];
  for (int j = 0; j < 4; ++j) {
    const double* p = parts[j];
    sums[j] = ((p[0] + p[4]) + (p[1] + p[5])) + ((p[2] + p[6]) + (p[3] + p[7]));
  }
}

SOFTFFD_CLONES
void solve_upper(int columns, int rows, std::size_t stride, const double* l, const double* inverse, double* y) {
  for (int j = columns - block; j >= 0; j -= block) {
    const double* panel = l + j * stride + j;
    double s[block];
    for (int k = 0; k < block; k += 4) multiply_four((rows - j) / block - 1, stride, panel + k * stride + block, y + j + block, s + k);
    for (int k = block - 1; k >= 0; --k) {
      double sum = y[j + k] - s[k];
      for (int i = k + 1; i < block; ++i) sum -= panel[k * stride + i] * y[j + i];
      y[j + k] = sum * inverse[j + k];
    }
  }
}

}  // namespace softffd::kernels
