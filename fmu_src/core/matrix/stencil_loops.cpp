#include "matrix/stencil_loops.hpp"

#include "machine/instructions.hpp"

namespace softffd::kernels {

namespace loops {

/// y += B x with 3 x 3 matrices B, of which rows are `row` entries apart and columns `column` entries.
INNER void add_three(int n, std::size_t lanes, std::size_t row, std::size_t column, In b, In x0, In x1, In x2, Out y0, Out y1, Out y2) {
  In b00 = b, b01 = b + column * lanes, b02 = b + 2 * column * lanes;
  In b10 = b00 + row * lanes, b11 = b01 + row * lanes, b12 = b02 + row * lanes;
  In b20 = b10 + row * lanes, b21 = b11 + row * lanes, b22 = b12 + row * lanes;
  for (int i = 0; i < n; ++i) {
    y0[i] += (b00[i] * x0[i] + b01[i] * x1[i]) + b02[i] * x2[i];
    y1[i] += (b10[i] * x0[i] + b11[i] * x1[i]) + b12[i] * x2[i];
    y2[i] += (b20[i] * x0[i] + b21[i] * x1[i]) + b22[i] * x2[i];
  }
}

INNER void add_products(int n, std::size_t lanes, std::size_t points, const double* b, const double* x, double* y) {
  add_three(n, lanes, 3, 1, b, x, x + points, x + 2 * points, y, y + points, y + 2 * points);
}

INNER void add_transposed_products(int n, std::size_t lanes, std::size_t points, const double* b, const double* x, double* y) {
  add_three(n, lanes, 1, 3, b, x, x + points, x + 2 * points, y, y + points, y + 2 * points);
}

INNER void symmetric_three(int n, std::size_t lanes, In s, In x0, In x1, In x2, Out y0, Out y1, Out y2) {
  In xx = s, yy = s + lanes, zz = s + 2 * lanes, xy = s + 3 * lanes, xz = s + 4 * lanes, yz = s + 5 * lanes;
  for (int i = 0; i < n; ++i) {
    y0[i] = (xx[i] * x0[i] + xy[i] * x1[i]) + xz[i] * x2[i];
    y1[i] = (xy[i] * x0[i] + yy[i] * x1[i]) + yz[i] * x2[i];
    y2[i] = (xz[i] * x0[i] + yz[i] * x1[i]) + zz[i] * x2[i];
  }
}

INNER void symmetric_products(int n, std::size_t lanes, std::size_t points, const double* s, const double* x, double* y) {
  symmetric_three(n, lanes, s, x, x + points, x + 2 * points, y, y + points, y + 2 * points);
}

INNER double dot(std::size_t n, const double* x, const double* y) {
  constexpr std::size_t width = 8;
  double parts[width] = {};
  const std::size_t whole = n / width * width;
  for (std::size_t at = 0; at < whole; at += width)
    for (std::size_t i = 0; i < width; ++i) parts[i] += x[at + i] * y[at + i];
  for (std::size_t i = 0; i < n - whole; ++i) parts[i] += x[whole + i] * y[whole + i];
  return ((parts[0] + parts[4]) + (parts[1] + parts[5])) + ((parts[2] + parts[6]) + (parts[3] + parts[7]));
}

}  // namespace loops

decltype(add_products) add_products = chosen<loops::add_products>();
decltype(add_transposed_products) add_transposed_products = chosen<loops::add_transposed_products>();
decltype(symmetric_products) symmetric_products = chosen<loops::symmetric_products>();
decltype(dot) dot = chosen<loops::dot>();

}  // namespace softffd::kernels
