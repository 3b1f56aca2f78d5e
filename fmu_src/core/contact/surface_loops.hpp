/// Loops over all points in contact with the surface, a register at a time; the bits are the same for any width.
#pragma once
#include <cstddef>

namespace softffd::kernels {

/// y += a x, n values each.
extern void (*const add_scaled)(std::size_t n, double a, const double* x, double* y);

/// sums (3 * points) = sum over rows of f_t (3 each) w_t (points each), one row after the other.
extern void (*const weighted_sums)(int points, int rows, const double* f, const double* w, double* sums);

/// The least of n >= 8 heights, and by how much any has come down at most; NaN if any is NaN or infinite.
struct Descent {
  double least, most;
};
extern Descent (*const descent)(std::size_t n, const double* before, const double* heights);

/// The energy that velocity changes a u at the beginning of a step and w at its end take [J], of points that move with v0 and v1 there:
/// -sum (m0 a u + m1 w) (v0 + v1) / 2. Masses (points), all else (3 * points).
extern double (*const energy_taken)(int points, const double* m0, double a, const double* u, const double* m1, const double* w,
                                    const double* v0, const double* v1);

}  // namespace softffd::kernels
