/// The loops in which a step spends its time: plain arrays, no branches, nothing that prevents vectorisation.
///
/// Every operation is elementwise and correctly rounded (no contraction, no reassociation). The vector width of the machine therefore
/// changes the speed and not one bit of the result.
#pragma once
#include <cstddef>

namespace softffd::kernels {

/// Added to squared lengths [m2], so that the force stays finite at r = 0: there l / 1e-140 times a zero vector is a zero force.
inline constexpr double smallest_square = 1e-280;

/// The springs of one direction: lane p joins points begin + p and begin + p + offset.
struct SpringRow {
  int begin, lanes, offset;
  const double* stiffness;    ///< k [N/m] (lanes); 0 where there is no spring
  const double* rest_length;  ///< l > 0 [m] (lanes)
};

/// s (6 * points) += weighted upper bounds of the springs' Hessians, c (e I + (1 - e) u u^T) with e = max(0, 1 - l/r), as xx yy zz xy xz
/// yz. The weight c is `first` at a spring's first point and `second` at the other (lanes). bounds = e I + (1 - e) u u^T of every lane,
/// (6 * lanes).
extern void (*const add_stiffness_bounds)(const SpringRow& springs, int points, const double* x, const double* first, const double* second,
                                          double* s, double* bounds);

/// v = a v + b (f + g), n values each.
extern void (*const kick)(std::size_t n, const double* a, const double* b, const double* f, const double* g, double* v);
/// w = a v + b (f + g) and y = x + h w, n values each.
extern void (*const kick_and_drift)(std::size_t n, const double* a, const double* b, const double* f, const double* g, double h,
                                    const double* v, const double* x, double* w, double* y);
/// y = x + h v, n values each.
extern void (*const drift)(std::size_t n, double h, const double* x, const double* v, double* y);

/// v += h (m f) with inverse masses m, n values each.
extern void (*const push)(std::size_t n, double h, const double* m, const double* f, double* v);
/// a = (f + g - d v) / m of points with masses m and damping d (points), and b = s a; all other arrays are (3 * points).
extern void (*const begin_kick)(int points, const double* m, const double* d, const double* f, const double* g, const double* v, double s,
                                double* a, double* b);
/// v = v0 + h (a - b), n values each.
extern void (*const end_kick)(std::size_t n, double h, const double* v0, const double* a, const double* b, double* v);
/// y = s x with one factor s per point (points); x and y are (3 * points), and y may be x.
extern void (*const scale)(int points, const double* s, const double* x, double* y);

/// a = m (f + g) with inverse masses m, n values each.
extern void (*const accelerate)(std::size_t n, const double* m, const double* f, const double* g, double* a);
/// a = m (f + g) - r v with damping rates r, n values each.
extern void (*const accelerate_damped)(std::size_t n, const double* m, const double* r, const double* f, const double* g, const double* v,
                                       double* a);
/// y = x + sum of w_j a_j over `count` arrays of n values each; y may be one of the arrays.
extern void (*const combine)(std::size_t n, const double* x, int count, const double* w, const double* const* a, double* y);
/// Returns the largest |x_i|; NaN if any is NaN or infinite.
extern double (*const largest)(std::size_t n, const double* x);
/// Returns the largest |w_i x_i|; NaN if any is NaN or infinite.
extern double (*const largest_weighted)(std::size_t n, const double* w, const double* x);

/// gap_p = normal . x_p - offset (points). Returns true if any gap is negative.
extern bool (*const gaps)(int points, const double* x, const double normal[3], double offset, double* gap);
/// bits = which of these gaps are negative, eight points per byte, the first in the lowest bit. Returns true if any gap is negative.
extern bool (*const behind)(int points, const double* x, const double normal[3], double offset, unsigned char* bits);

/// Returns the largest squared change of the spring vectors of one direction between two states [m2]; NaN if any is NaN or infinite.
extern double (*const largest_change)(const SpringRow& springs, int points, const double* x, const double* y);

/// block = Hessians of the springs and matrices of their dashpots, k (u u^T + e (I - u u^T)) + per_time c u u^T with e = 1 - l/r, as xx
/// yy zz xy xz yz (6 * lanes). A negative e is multiplied by `softening`. sums += these matrices at both ends (6 * points). dashpot: c
/// (lanes).
extern void (*const add_spring_matrices)(const SpringRow& springs, const double* dashpot, int points, const double* x, double softening,
                                         double per_time, double* block, double* sums);
/// f -= the same matrices times u. x, u, f: (3 * points); scratch: (3 * lanes).
extern void (*const subtract_spring_products)(const SpringRow& springs, const double* dashpot, int points, const double* x,
                                              double softening, double per_time, const double* u, double* f, double* scratch);

}  // namespace softffd::kernels
