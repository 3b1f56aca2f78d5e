#include "matrix/spring_hessian.hpp"

#include "matrix/spring_assembly.hpp"

namespace softffd {

/// Large lattices that never solve are spared the memory: it is first touched by `compute`.
SpringHessian::SpringHessian(int points) : blocks_(directions.size()), sums_(6 * points) {
  for (Scalars& blocks : blocks_) blocks.resize(6 * points);
}

void SpringHessian::compute(const Springs& springs, const Points& x, double softening, double per_time) {
  sums_.setZero();
  const bool damped = springs.dashpots();
  for (std::size_t r = 0; r < springs.rows().size(); ++r) {
    const Springs::Row& row = springs.rows()[r];
    kernels::add_spring_matrices(row.view(), (damped ? row.dashpot : row.stiffness).data(), int(x.rows()), x.data(), softening,
                                 damped ? per_time : 0, blocks_[r].data(), sums_.data());
  }
}

void SpringHessian::subtract_product(const Springs& springs, const Points& u, Points& f) const {
  for (std::size_t r = 0; r < springs.rows().size(); ++r)
    kernels::subtract_spring_products(springs.rows()[r].view(), int(u.rows()), blocks_[r].data(), u.data(), f.data(), springs.scratch());
}

void SpringHessian::fill(const Body& body, const Scalars& diagonal, LatticeMatrix& matrix) const {
  matrix.clear();
  for (std::size_t r = 0; r < body.springs.rows().size(); ++r) {
    const Springs::Row& row = body.springs.rows()[r];
    const double* h = blocks_[r].data();
    set_couplings(body, row, matrix, [&](int lane, int component) { return h[component * row.lanes() + lane]; });
  }
  set_diagonal_blocks(body, sums_, diagonal, matrix);
}

}  // namespace softffd
