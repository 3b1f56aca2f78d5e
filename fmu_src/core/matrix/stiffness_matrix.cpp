#include "matrix/stiffness_matrix.hpp"

#include "matrix/spring_assembly.hpp"
#include "matrix/volume_hessian.hpp"

namespace softffd {

namespace {

/// What a row's dashpots add, c per_time u u^T.
struct AlongDashpots {
  const Springs::Row& row;
  const Points& x;
  double per_time;

  double operator()(int lane, int a, int b) const {
    const int p = row.begin + lane, q = p + row.offset;
    double squared = kernels::smallest_square;
    for (int axis = 0; axis < 3; ++axis) squared += (x(q, axis) - x(p, axis)) * (x(q, axis) - x(p, axis));
    return per_time * row.dashpot[lane] * (x(q, a) - x(p, a)) * (x(q, b) - x(p, b)) / squared;
  }
  void add_to(Scalars& sums) const {
    const int n = int(x.rows());
    for (int lane = 0; lane < row.lanes(); ++lane)
      for (int a = 0; a < 3; ++a)
        for (int b = a; b < 3; ++b) {
          const double entry = (*this)(lane, a, b);
          double* sum = sums.data() + component[a][b] * n + row.begin + lane;
          *sum += entry, sum[row.offset] += entry;
        }
  }
};

}  // namespace

void assemble(const Body& body, const Points& x, const Scalars& diagonal, Scalars& sums, LatticeMatrix& matrix, double per_time) {
  double* bounds = body.springs.scratch();
  const bool dashpots = per_time > 0 && body.springs.dashpots();
  matrix.clear();
  sums.setZero();
  for (const Springs::Row& row : body.springs.rows()) {
    const double* k = row.stiffness.data();
    kernels::add_stiffness_bounds(row.view(), body.points(), x.data(), k, k, sums.data(), bounds);
    const auto spring = [&](int lane, int component) { return k[lane] * bounds[component * row.lanes() + lane]; };
    if (!dashpots) {
      set_couplings(body, row, matrix, spring);
      continue;
    }
    const AlongDashpots dashpot{row, x, per_time};
    dashpot.add_to(sums);
    set_couplings(body, row, matrix, [&](int lane, int c) { return spring(lane, c) + dashpot(lane, axes[c][0], axes[c][1]); });
  }
  set_diagonal_blocks(body, sums, diagonal, matrix);
  if (body.volume) add_stiffness(*body.volume, x, body.pinned, matrix);
}

void stiffness_force(const Body& body, const Points& x, const Points& u, Points& f) {
  f.setZero();
  for (const Springs::Row& row : body.springs.rows())
    kernels::subtract_stiffness_product(row.view(), int(x.rows()), x.data(), u.data(), f.data(), body.springs.scratch());
  if (body.volume) subtract_stiffness_product(*body.volume, x, u, f);
}

}  // namespace softffd
