/// The loops of the Cholesky factor over panels of columns. As in kernels.hpp, the bits do not depend on the vector width.
#pragma once
#include <cstddef>

namespace softffd::kernels {

/// Columns and rows of panels come in blocks of this many. Columns are `stride` apart, columns of c are `c_stride` apart.
inline constexpr int block = 8;
/// Eight columns c, 8 `blocks` rows: c -= sum over `count` columns a_k of a_k times its first eight values; `count` is a multiple of 4.
extern void (*const subtract_products)(int blocks, int count, std::size_t stride, const double* a, std::size_t c_stride, double* c);
/// Computes the Cholesky factor of eight columns c with 8 `blocks` rows. The first eight rows are the diagonal block; its entries above
/// the diagonal have no meaning afterwards. inverse (8): 1 / diagonal of the factor.
extern void (*const factor_panel)(int blocks, std::size_t stride, double* c, double* inverse);
/// y <- L^-1 y for `columns` columns of a factor with `rows` >= `columns` rows: solves for the first `columns` values and subtracts their
/// products from the rest.
extern void (*const solve_lower)(int columns, int rows, std::size_t stride, const double* l, const double* inverse, double* y);
/// y <- L^-T y for the first `columns` values; the rest of the `rows` values is already solved for.
extern void (*const solve_upper)(int columns, int rows, std::size_t stride, const double* l, const double* inverse, double* y);

/// Both for `block` right-hand sides at once, side by side: value i of side s is y[block i + s].
extern void (*const solve_lower_together)(int columns, int rows, std::size_t stride, const double* l, const double* inverse, double* y);
extern void (*const solve_upper_together)(int columns, int rows, std::size_t stride, const double* l, const double* inverse, double* y);

}  // namespace softffd::kernels
