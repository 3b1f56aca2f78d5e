#include "matrix/panels.hpp"

#include <cmath>

#include "machine/lanes.hpp"

namespace softffd::kernels {

namespace loops {

/// Subtracts from two columns c four columns a times the values at s, s + stride, ...: few enough to stay in registers.
INNER void subtract_four(int n, std::size_t stride, const double* a, const double* s, Out c0, Out c1) {
  In a0 = a, a1 = a + stride, a2 = a + 2 * stride, a3 = a + 3 * stride;
  const double p0 = s[0], p1 = s[stride], p2 = s[2 * stride], p3 = s[3 * stride];
  const double q0 = s[1], q1 = s[stride + 1], q2 = s[2 * stride + 1], q3 = s[3 * stride + 1];
  for (int i = 0; i < n; ++i) {
    c0[i] -= (a0[i] * p0 + a1[i] * p1) + (a2[i] * p2 + a3[i] * p3);
    c1[i] -= (a0[i] * q0 + a1[i] * q1) + (a2[i] * q2 + a3[i] * q3);
  }
}

INNER void subtract_products(int blocks, int count, std::size_t stride, const double* a, std::size_t c_stride, double* c) {
  const int n = block * blocks;
  for (int k = 0; k < count; k += 4, a += 4 * stride)
    for (int j = 0; j < block; j += 2) subtract_four(n, stride, a, a + j, c + j * c_stride, c + (j + 1) * c_stride);
}

/// The same sums for machines with eight registers of n numbers and four more: n rows of c stay in registers throughout the loop over
/// columns.
template <int n>
INNER void subtract_from_tile(int count, std::size_t stride, const double* a, const double* s, std::size_t c_stride, double* c) {
  Lanes<n> sums[block];
  for (int j = 0; j < block; ++j) sums[j] = load<n>(c + j * c_stride);
  for (int k = 0; k < count; k += 4, a += 4 * stride, s += 4 * stride) {
    const Lanes<n> a0 = load<n>(a), a1 = load<n>(a + stride), a2 = load<n>(a + 2 * stride), a3 = load<n>(a + 3 * stride);
    for (int j = 0; j < block; ++j) sums[j] -= (a0 * s[j] + a1 * s[stride + j]) + (a2 * s[2 * stride + j] + a3 * s[3 * stride + j]);
  }
  for (int j = 0; j < block; ++j) store<n>(c + j * c_stride, sums[j]);
}

template <int n>
INNER void subtract_products_by_tiles(int blocks, int count, std::size_t stride, const double* a, std::size_t c_stride, double* c) {
  for (int b = 0; b < blocks * block; b += n) subtract_from_tile<n>(count, stride, a + b, a, c_stride, c + b);
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

INNER void factor_panel(int blocks, std::size_t stride, double* c, double* inverse) {
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

INNER void solve_lower(int columns, int rows, std::size_t stride, const double* l, const double* inverse, double* y) {
  for (int j = 0; j < columns; j += block) {
    const double* panel = l + j * stride + j;
    double s[block];
    for (int i = 0; i < block; ++i) s[i] = y[j + i];
#pragma GCC unroll 8  // only then s is in registers
    for (int k = 0; k < block; ++k) {
      s[k] *= inverse[j + k];
#pragma GCC unroll 8
      for (int i = k + 1; i < block; ++i) s[i] -= panel[k * stride + i] * s[k];
    }
    for (int i = 0; i < block; ++i) y[j + i] = s[i];
    subtract_eight((rows - j) / block * block - block, stride, panel + block, s, y + j + block);
  }
}

/// s -= products of four columns with y. Each product is summed in eight partial sums, n of them in a register.
template <int n>
INNER void subtract_multiplied(int blocks, std::size_t stride, const double* l, const double* y, double* s) {
  Lanes<n> parts[4][block / n] = {};
  for (int b = 0; b < blocks; ++b, l += block, y += block)
    for (int i = 0; i < block / n; ++i) {
      const Lanes<n> rows = load<n>(y + i * n);
      for (int j = 0; j < 4; ++j) parts[j][i] += load<n>(l + j * stride + i * n) * rows;
    }
  for (int j = 0; j < 4; ++j) {
    double p[block];
    for (int i = 0; i < block / n; ++i) store<n>(p + i * n, parts[j][i]);
    s[j] -= ((p[0] + p[4]) + (p[1] + p[5])) + ((p[2] + p[6]) + (p[3] + p[7]));
  }
}

template <int n>
INNER void solve_upper(int columns, int rows, std::size_t stride, const double* l, const double* inverse, double* y) {
  for (int j = columns - block; j >= 0; j -= block) {
    const double* panel = l + j * stride + j;
    double s[block];
    for (int k = 0; k < block; ++k) s[k] = y[j + k];
    for (int k = 0; k < block; k += 4)
      subtract_multiplied<n>((rows - j) / block - 1, stride, panel + k * stride + block, y + j + block, s + k);
#pragma GCC unroll 8
    for (int k = block - 1; k >= 0; --k) {
#pragma GCC unroll 8
      for (int i = k + 1; i < block; ++i) s[k] -= panel[k * stride + i] * s[i];
      s[k] *= inverse[j + k];
    }
    for (int k = 0; k < block; ++k) y[j + k] = s[k];
  }
}

/// The same for `block` right-hand sides side by side, n of them in a register.
template <int n>
INNER void solve_lower_together(int columns, int rows, std::size_t stride, const double* l, const double* inverse, double* y) {
  for (int j = 0; j < columns; j += block)
    for (int side = 0; side < block; side += n) {
      const double* panel = l + j * stride + j;
      double* at = y + j * block + side;
      Lanes<n> s[block];
      for (int k = 0; k < block; ++k) s[k] = load<n>(at + k * block);
#pragma GCC unroll 8
      for (int k = 0; k < block; ++k) {
        s[k] *= inverse[j + k];
#pragma GCC unroll 8
        for (int i = k + 1; i < block; ++i) s[i] -= panel[k * stride + i] * s[k];
        store<n>(at + k * block, s[k]);
      }
      for (int i = block; i < rows - j; ++i) {
        const double* of_row = panel + i;
        store<n>(at + i * block,
                 load<n>(at + i * block) -
                     (((of_row[0] * s[0] + of_row[stride] * s[1]) + (of_row[2 * stride] * s[2] + of_row[3 * stride] * s[3])) +
                      ((of_row[4 * stride] * s[4] + of_row[5 * stride] * s[5]) + (of_row[6 * stride] * s[6] + of_row[7 * stride] * s[7]))));
      }
    }
}

template <int n>
INNER void solve_upper_together(int columns, int rows, std::size_t stride, const double* l, const double* inverse, double* y) {
  for (int j = columns - block; j >= 0; j -= block)
    for (int side = 0; side < block; side += n) {
      const double* panel = l + j * stride + j;
      double* at = y + j * block + side;
      Lanes<n> s[block];
      for (int k = 0; k < block; ++k) s[k] = load<n>(at + k * block);
      for (int i = block; i < rows - j; ++i) {
        const Lanes<n> solved = load<n>(at + i * block);
        for (int k = 0; k < block; ++k) s[k] -= panel[k * stride + i] * solved;
      }
#pragma GCC unroll 8
      for (int k = block - 1; k >= 0; --k) {
#pragma GCC unroll 8
        for (int i = k + 1; i < block; ++i) s[k] -= panel[k * stride + i] * s[i];
        s[k] *= inverse[j + k];
        store<n>(at + k * block, s[k]);
      }
    }
}

}  // namespace loops

decltype(subtract_products) subtract_products =
    chosen<loops::subtract_products, loops::subtract_products_by_tiles<4>, loops::subtract_products_by_tiles<8>>();
decltype(factor_panel) factor_panel = chosen<loops::factor_panel>();
decltype(solve_lower) solve_lower = chosen<loops::solve_lower>();
decltype(solve_upper) solve_upper = chosen<loops::solve_upper<2>, loops::solve_upper<4>, loops::solve_upper<8>>();
decltype(solve_lower_together) solve_lower_together =
    chosen<loops::solve_lower_together<2>, loops::solve_lower_together<4>, loops::solve_lower_together<8>>();
decltype(solve_upper_together) solve_upper_together =
    chosen<loops::solve_upper_together<2>, loops::solve_upper_together<4>, loops::solve_upper_together<8>>();

}  // namespace softffd::kernels
