/// Loops over the control points for contact of the surface, one register at a time. The bits are the same for any register width.
#pragma once
#include <cstddef>

#include "body/samples.hpp"

namespace softffd::kernels {

/// For the points of the range, sums (3 * points) = sum over rows of f_t (3 each) w_t (points each), one row after the other.
extern void (*const weighted_sums)(int points, PointRange range, int rows, const double* f, const double* w, double* sums);

/// For each row, sums its weights w_t (points each) times x (3 * points) over the points of the range, to (3 each); or times values
/// (points).
extern void (*const row_places)(int points, PointRange range, int rows, const double* w, const double* x, double* places);
extern void (*const row_values)(int points, PointRange range, int rows, const double* w, const double* values, double* sums);

/// gaps (points) += normal . move, (3 * points), for the points of the range.
extern void (*const add_motion)(int points, PointRange range, const double normal[3], const double* move, double* gaps);

/// v += a move and, unless x is null, x += move for the points of the range; all (3 * points).
extern void (*const move_points)(int points, PointRange range, const double* move, double a, double* v, double* x);

/// speeds_p = normal . v_p (points). Returns the largest |v_p|^2; NaN if any is NaN or infinite.
extern double (*const speeds)(int points, const double normal[3], const double* v, double* speeds);

/// The least of n >= 8 gaps, and the largest decrease of any of them since `before`; NaN if any gap is NaN or infinite.
struct Descent {
  double least, most;
};
extern Descent (*const descent)(std::size_t n, const double* before, const double* gaps);

/// Returns the energy [J] that the velocity changes a u at the start of a step and w at its end take from points with velocities v0 and
/// v1 there: -sum (m0 a u + m1 w) (v0 + v1) / 2 over the points of the range. Masses (points), all else (3 * points).
extern double (*const energy_taken)(int points, PointRange range, const double* m0, double a, const double* u, const double* m1,
                                    const double* w, const double* v0, const double* v1);

}  // namespace softffd::kernels
