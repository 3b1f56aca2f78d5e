/// The loops of the conjugate gradients. As in panels.hpp, the bits do not depend on the vector width.
#pragma once
#include <cstddef>

namespace softffd::kernels {

/// 3 x 3 matrices B, one for each of `lanes` lanes: entry (a, b) of lane i is b[(3 a + b) * lanes + i]. Only the first `n` lanes count.
/// The coordinates of vectors are `points` apart.
///
/// y += B x, lane by lane.
extern void (*const add_products)(int n, std::size_t lanes, std::size_t points, const double* b, const double* x, double* y);
/// y += B^T x, lane by lane.
extern void (*const add_transposed_products)(int n, std::size_t lanes, std::size_t points, const double* b, const double* x, double* y);
/// y = S x for symmetric matrices S, stored as xx yy zz xy xz yz.
extern void (*const symmetric_products)(int n, std::size_t lanes, std::size_t points, const double* s, const double* x, double* y);
/// Returns the sum of x_i y_i, added up in eight partial sums.
extern double (*const dot)(std::size_t n, const double* x, const double* y);

}  // namespace softffd::kernels
