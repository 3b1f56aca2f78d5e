/// The loops of the Cholesky factor: panels of columns, as kernels.hpp's the same bits whatever the vector width.
#pragma once
#include <cstddef>

namespace softffd::kernels {

/// Columns and rows of panels come in blocks of this many; columns are `stride` apart, those of c `c_stride`.
inline constexpr int block = 8;
/// Eight columns c -= sum over `count` columns a_k of a_k times the first eight values of a_k; 8 `blocks` rows, `count` a multiple of 4.
extern void (*const subtract_products)(int blocks, int count, std::size_t stride, const double* a, std::size_t c_stride, double* c);
/// Cholesky factor of eight columns c with 8 `blocks` rows, the first eight of which are the diagonal block; above its diagonal nothing is
/// left that has a meaning. inverse (8): 1 / diagonal of the factor.
extern void (*const factor_panel)(int blocks, std::size_t stride, double* c, double* inverse);
/// y <- L^-1 y for `columns` columns of a factor with `rows` >= `columns` rows: solves for the first values and subtracts them from the
/// rest.
extern void (*const solve_lower)(int columns, int rows, std::size_t stride, const double* l, const double* inverse, double* y);
/// The first `columns` values y <- L^-T y, the rest of the `rows` being solved for.
extern void (*const solve_upper)(int columns, int rows, std::size_t stride, const double* l, const double* inverse, double* y);

/// Both for as many right sides as a block has at once, side by side: value i of side s is y[block i + s].
extern void (*const solve_lower_together)(int columns, int rows, std::size_t stride, const double* l, const double* inverse, double* y);
extern void (*const solve_upper_together)(int columns, int rows, std::size_t stride, const double* l, const double* inverse, double* y);

}  // namespace softffd::kernels
