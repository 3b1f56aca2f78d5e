#include "matrix/stiffness_matrix.hpp"

#include <limits>

#include "matrix/spring_assembly.hpp"
#include "matrix/volume_hessian.hpp"

namespace softffd {

namespace {

/// A row's matrices with those of its dashpots, which are u u^T: what a spring has that is infinitely far below its rest length.
class WithDashpots {
 public:
  WithDashpots(const Body& body, const Springs::Row& row, const Points& x, double per_time, const double* bounds, Scalars& sums)
      : lanes_(row.lanes()), entries_(6 * lanes_) {
    const Scalars push = per_time * row.dashpot, far = Scalars::Constant(lanes_, std::numeric_limits<double>::infinity());
    for (int c = 0; c < 6; ++c) part(c) = row.stiffness * Eigen::Map<const Scalars>(bounds + c * lanes_, lanes_);
    kernels::SpringRow along = row.view();
    along.rest_length = far.data();
    Scalars directions(6 * lanes_);
    kernels::add_stiffness_bounds(along, body.points(), x.data(), push.data(), push.data(), sums.data(), directions.data());
    for (int c = 0; c < 6; ++c) part(c) += push * directions.segment(c * lanes_, lanes_);
  }
  double operator()(int lane, int component) const { return entries_[component * lanes_ + lane]; }

 private:
  Eigen::VectorBlock<Scalars> part(int c) { return entries_.segment(c * lanes_, lanes_); }
  int lanes_;
  Scalars entries_;
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
    if (dashpots)
      set_couplings(body, row, matrix, WithDashpots(body, row, x, per_time, bounds, sums));
    else
      set_couplings(body, row, matrix, [&](int lane, int component) { return k[lane] * bounds[component * row.lanes() + lane]; });
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
