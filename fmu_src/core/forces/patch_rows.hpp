/// A patch of 4 x 4 x 4 nodes in registers, as sixteen rows of four numbers along x; row (j, k) has number j + 4 k. Lanes are combined by
/// broadcasts alone, and every sum has one fixed order, so that the bits of the result are the same for any register width. Only files
/// with vectorised loops include this file.
#pragma once
#include "forces/solid_kernels.hpp"
#include "machine/lanes.hpp"
#include "model/lobatto.hpp"

namespace softffd::kernels::patch {

/// Four numbers, in registers of n numbers each.
template <int n>
struct Four {
  Lanes<n> part[4 / n];
};

template <int n, class F>
INNER Four<n> each_part(F&& f) {
  Four<n> result;
  for (int i = 0; i < 4 / n; ++i) result.part[i] = f(i);
  return result;
}
/// Copies register by register. Compilers copy structures in pieces, from which processors cannot load a whole register without a stall.
template <int n>
INNER void copy(const Four<n>& from, Four<n>& to) {
  for (int i = 0; i < 4 / n; ++i) to.part[i] = from.part[i];
}
template <int n>
INNER Four<n> operator+(const Four<n>& a, const Four<n>& b) {
  return each_part<n>([&](int i) INLINED { return a.part[i] + b.part[i]; });
}
template <int n>
INNER Four<n> operator-(const Four<n>& a, const Four<n>& b) {
  return each_part<n>([&](int i) INLINED { return a.part[i] - b.part[i]; });
}
template <int n>
INNER Four<n> operator*(const Four<n>& a, const Four<n>& b) {
  return each_part<n>([&](int i) INLINED { return a.part[i] * b.part[i]; });
}
template <int n>
INNER Four<n> operator/(const Four<n>& a, const Four<n>& b) {
  return each_part<n>([&](int i) INLINED { return a.part[i] / b.part[i]; });
}
template <int n>
INNER Four<n> operator/(double a, const Four<n>& b) {
  return each_part<n>([&](int i) INLINED { return a / b.part[i]; });
}
template <int n>
INNER Four<n> operator*(double a, const Four<n>& b) {
  return each_part<n>([&](int i) INLINED { return a * b.part[i]; });
}
template <int n>
INNER Four<n> operator-(const Four<n>& a, double b) {
  return each_part<n>([&](int i) INLINED { return a.part[i] - b; });
}
template <int n>
INNER Four<n> operator+(const Four<n>& a, double b) {
  return each_part<n>([&](int i) INLINED { return a.part[i] + b; });
}
template <int n>
INNER Four<n> operator-(double a, const Four<n>& b) {
  return each_part<n>([&](int i) INLINED { return a - b.part[i]; });
}
template <int n>
INNER Four<n> larger(const Four<n>& a, double b) {
  return each_part<n>([&](int i) INLINED { return a.part[i] > b ? a.part[i] : Lanes<n>{} + b; });
}
template <int n>
INNER Four<n> larger(const Four<n>& a, const Four<n>& b) {
  return each_part<n>([&](int i) INLINED { return a.part[i] > b.part[i] ? a.part[i] : b.part[i]; });
}
/// Returns a, limited to the range from -most to most.
template <int n>
INNER Four<n> within(const Four<n>& a, const Four<n>& most) {
  return each_part<n>([&](int i) INLINED {
    const Lanes<n> b = most.part[i], low = a.part[i] < -b ? -b : a.part[i];
    return low > b ? b : low;
  });
}
template <int n>
INNER Four<n> root(const Four<n>& a) {
  return each_part<n>([&](int i) INLINED { return square_root<n>(a.part[i]); });
}
/// Returns number i of a from memory: a broadcast of a number in memory takes no shuffle.
template <int n>
INNER double number(const Four<n>& a, int i) {
  double found;
  std::memcpy(&found, reinterpret_cast<const char*>(&a) + i * sizeof found, sizeof found);
  return found;
}
template <int n>
INNER Four<n> load_four(const double* from) {
  return each_part<n>([&](int i) INLINED { return load<n>(from + n * i); });
}
template <int n>
INNER void store_four(double* to, const Four<n>& a) {
  for (int i = 0; i < 4 / n; ++i) store<n>(to + n * i, a.part[i]);
}
template <int n>
INNER double sum_of(const Four<n>& a) {
  return (number(a, 0) + number(a, 1)) + (number(a, 2) + number(a, 3));
}
template <int n>
INNER double largest_of(const Four<n>& a) {
  double most = number(a, 0);
  for (int i = 1; i < 4; ++i) most = number(a, i) > most ? number(a, i) : most;
  return most;
}

constexpr int rows = 16;
template <int n>
using Rows = Four<n>[rows];

/// Computes the derivative along a line of four nodes, v = D u / a, from the even and the odd part of u about the middle of the line:
///
///      (v0 + v3) / 2 = -3.5 (u0 - u3) + 2.5 r (u1 - u2),     (v0 - v3) / 2 = 2.5 w,      w = (u1 + u2) - (u0 + u3),
///      (v1 + v2) / 2 = -0.5 (u0 - u3) - 0.5 r (u1 - u2),     (v1 - v2) / 2 = 0.5 r w,    r = sqrt 5.
template <int n>
INNER void derive_line(const LineShape& by, const Four<n>& u0, const Four<n>& u1, const Four<n>& u2, const Four<n>& u3, Four<n>* v,
                       int step) {
  const Four<n> outer = u0 - u3, inner = u1 - u2, w = (u1 + u2) - (u0 + u3);
  const Four<n> ends = by.inner_at_end * inner - by.outer_at_end * outer, middles = by.middle * outer + by.root * inner;
  const Four<n> at_end = by.even * w, at_middle = by.root * w;
  v[0] = ends + at_end;
  v[step] = at_middle - middles;
  v[2 * step] = -1.0 * (at_middle + middles);
  v[3 * step] = ends - at_end;
}

/// Adds the transposed derivative: f += D' p / a.
template <int n>
INNER void add_transposed_line(const LineShape& by, const Four<n>* p, Four<n>* f, int step) {
  const Four<n> ends = p[0] + p[3 * step], middles = p[step] + p[2 * step];
  const Four<n> w = by.even * (p[0] - p[3 * step]) + by.root * (p[step] - p[2 * step]);
  const Four<n> outer = by.outer_at_end * ends + by.middle * middles, inner = by.inner_at_end * ends - by.root * middles;
  f[0] = f[0] - (w + outer);
  f[step] = f[step] + (w + inner);
  f[2 * step] = f[2 * step] + (w - inner);
  f[3 * step] = f[3 * step] - (w - outer);
}

/// Computes the derivatives of a field along the three axes; F[0] is the derivative along x.
template <int n>
INNER void derive(const SolidBody& body, const double* from, Rows<n>* F) {
  const PatchShape& shape = body.shape;
  Rows<n> u;
  Four<n> along[4];
  for (int s = 0; s < 4; ++s) along[s] = load_four<n>(shape.along[s]);
  for (int r = 0; r < rows; ++r) {
    const double* at = from + (r & 3) * body.line + (r >> 2) * body.layer;
    u[r] = load_four<n>(at);
    F[0][r] = (at[0] * along[0] + at[1] * along[1]) + (at[2] * along[2] + at[3] * along[3]);
  }
  for (int k = 0; k < rows; k += 4) derive_line<n>(shape.y, u[k], u[k + 1], u[k + 2], u[k + 3], F[1] + k, 1);
  for (int j = 0; j < 4; ++j) derive_line<n>(shape.z, u[j], u[j + 4], u[j + 8], u[j + 12], F[2] + j, 4);
}

/// to -= the transposed derivatives of the nodal values P, summed over the three axes.
template <int n>
INNER void subtract_divergence(const SolidBody& body, const Rows<n>* P, double* to) {
  const PatchShape& shape = body.shape;
  Four<n> back[4];
  for (int i = 0; i < 4; ++i) back[i] = load_four<n>(shape.back[i]);
  Rows<n> sums;
  for (int r = 0; r < rows; ++r) {
    const Four<n>& a = P[0][r];
    sums[r] = (number(a, 0) * back[0] + number(a, 1) * back[1]) + (number(a, 2) * back[2] + number(a, 3) * back[3]);
  }
  for (int k = 0; k < rows; k += 4) add_transposed_line<n>(shape.y, P[1] + k, sums + k, 1);
  for (int j = 0; j < 4; ++j) add_transposed_line<n>(shape.z, P[2] + j, sums + j, 4);
  for (int r = 0; r < rows; ++r) {
    double* at = to + (r & 3) * body.line + (r >> 2) * body.layer;
    store_four<n>(at, load_four<n>(at) - sums[r]);
  }
}

/// t = Pi q: the orthogonal projection onto products of linear functions of the axes, in the inner product of the quadrature. Moments
/// along z and y are taken first, then one sum along x, and back.
template <int n>
INNER void project(const PatchShape& shape, const Rows<n>& q, Rows<n>& t) {
  constexpr double mean[2] = {lobatto::weights[0], lobatto::weights[1]};
  constexpr double inner = 1 / lobatto::root5, square = 1.0 / 3;  // nodes on [-1, 1]: place of the inner ones; sum of w x^2
  constexpr double slope[2] = {mean[0] / square, mean[1] * inner / square};
  constexpr double at[4] = {-1, -inner, inner, 1};
  Four<n> column[4], a[2][4];
  for (int s = 0; s < 4; ++s) column[s] = load_four<n>(shape.projector[s]);
  for (int j = 0; j < 4; ++j) {
    a[0][j] = mean[0] * (q[j] + q[12 + j]) + mean[1] * (q[4 + j] + q[8 + j]);
    a[1][j] = slope[0] * (q[12 + j] - q[j]) + slope[1] * (q[8 + j] - q[4 + j]);
  }
  for (auto& v : a) {
    Four<n> moments[2] = {mean[0] * (v[0] + v[3]) + mean[1] * (v[1] + v[2]), slope[0] * (v[3] - v[0]) + slope[1] * (v[2] - v[1])};
    for (Four<n>& m : moments)
      m = (number(m, 0) * column[0] + number(m, 1) * column[1]) + (number(m, 2) * column[2] + number(m, 3) * column[3]);
    for (int j = 0; j < 4; ++j) v[j] = moments[0] + at[j] * moments[1];
  }
  for (int k = 0; k < 4; ++k)
    for (int j = 0; j < 4; ++j) t[j + 4 * k] = a[0][j] + at[k] * a[1][j];
}

/// One 3 x 3 matrix for each node of a row; component c along axis a is entry 3 c + a.
template <int n>
struct Nine {
  Four<n> m[9];
  INLINED const Four<n>& operator()(int c, int a) const { return m[3 * c + a]; }
};
template <int n>
INNER Nine<n> row_of(const Rows<n>* F, int r) {
  Nine<n> f;
  for (int i = 0; i < 9; ++i) copy(F[i][r], f.m[i]);
  return f;
}
/// Returns the cofactors of F. The sum of their products with the entries of F is three times the determinant.
template <int n>
INNER Nine<n> cofactors(const Nine<n>& f) {
  const Four<n>* m = f.m;
  return {{m[4] * m[8] - m[5] * m[7], m[5] * m[6] - m[3] * m[8], m[3] * m[7] - m[4] * m[6],  //
           m[7] * m[2] - m[8] * m[1], m[8] * m[0] - m[6] * m[2], m[6] * m[1] - m[7] * m[0],  //
           m[1] * m[5] - m[2] * m[4], m[2] * m[3] - m[0] * m[5], m[0] * m[4] - m[1] * m[3]}};
}
/// Returns the derivative of the cofactors of f in the direction g.
template <int n>
INNER Nine<n> cofactors(const Nine<n>& f, const Nine<n>& g) {
  const Four<n>*m = f.m, *d = g.m;
  const auto pair = [&](int a, int b, int c, int e) INLINED { return (d[a] * m[b] + m[a] * d[b]) - (d[c] * m[e] + m[c] * d[e]); };
  return {{pair(4, 8, 5, 7), pair(5, 6, 3, 8), pair(3, 7, 4, 6),  //
           pair(7, 2, 8, 1), pair(8, 0, 6, 2), pair(6, 1, 7, 0),  //
           pair(1, 5, 2, 4), pair(2, 3, 0, 5), pair(0, 4, 1, 3)}};
}
template <int n>
INNER Four<n> dot(const Nine<n>& a, const Nine<n>& b) {
  Four<n> sum = a.m[0] * b.m[0];
  for (int i = 1; i < 9; ++i) sum = sum + a.m[i] * b.m[i];
  return sum;
}
template <int n>
INNER Four<n> determinant(const Nine<n>& f) {
  const Four<n>* m = f.m;
  return m[0] * (m[4] * m[8] - m[5] * m[7]) + m[1] * (m[5] * m[6] - m[3] * m[8]) + m[2] * (m[3] * m[7] - m[4] * m[6]);
}

INNER double larger(double a, double b) { return a > b ? a : b; }
INNER double root(double a) { return std::sqrt(a); }

/// Returns the largest eigenvalue of a symmetric 3 x 3 matrix, or a little more, from its trace, the sum of its principal minors and its
/// determinant. Newton's method descends to the eigenvalue from the bound by the first two invariants, which is exact where the two
/// smaller eigenvalues agree. Where eigenvalues agree, as for a body that only turns, the slope is lost in rounding: it is replaced by a
/// larger one, with which the value descends less.
template <class Number>
INNER Number top(const Number& trace, const Number& minors, const Number& determinant) {
  const Number least = larger(1e-8 * (trace * trace - 2.0 * minors), 1e-300);
  Number value = (1.0 / 3) * trace + root(larger((4.0 / 9) * (trace * trace) - (4.0 / 3) * minors, 0.0));
  for (int step = 0; step < 3; ++step) {
    const Number above = ((value - trace) * value + minors) * value - determinant, slope = (3.0 * value - 2.0 * trace) * value + minors;
    value = value - larger(above, 0.0) / larger(slope, least);
  }
  return value;
}

/// Returns the square of a matrix's largest singular value.
INNER double norm(const double (&m)[9]) {
  double s[3][3];
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) s[a][b] = m[a] * m[b] + m[3 + a] * m[3 + b] + m[6 + a] * m[6 + b];
  const double xy = s[0][0] * s[1][1] - s[0][1] * s[0][1], xz = s[0][0] * s[2][2] - s[0][2] * s[0][2],
               yz = s[1][1] * s[2][2] - s[1][2] * s[1][2];
  const double all = m[0] * (m[4] * m[8] - m[5] * m[7]) + m[1] * (m[5] * m[6] - m[3] * m[8]) + m[2] * (m[3] * m[7] - m[4] * m[6]);
  return top(s[0][0] + s[1][1] + s[2][2], xy + xz + yz, all * all);
}

/// Returns the same for F at the nodes of a row, from its cofactors c and its determinant `volume`.
template <int n>
INNER Four<n> longest_square(const Nine<n>& f, const Nine<n>& c, const Four<n>& volume) {
  return top(dot(f, f), dot(c, c), volume * volume);
}

}  // namespace softffd::kernels::patch
