#include "matrix/spring_hessian.hpp"

#include <algorithm>
#include <cmath>

#include "matrix/spring_assembly.hpp"

namespace softffd {

namespace {

/// Least 1 - l/r that counts: keeps the matrix of a spring without length finite.
constexpr double lowest = -1e6;

}  // namespace

/// Large lattices that never solve are spared the memory: it is first touched by `compute`.
SpringHessian::SpringHessian(int points) : blocks_(directions.size()), sums_(6 * points) {
  for (Scalars& blocks : blocks_) blocks.resize(6 * points);
}

void SpringHessian::compute(const Springs& springs, const Points& x, double softening, double per_time) {
  const int n = int(x.rows());
  sums_.setZero();
  for (std::size_t r = 0; r < springs.rows().size(); ++r) {
    const Springs::Row& row = springs.rows()[r];
    const int lanes = row.lanes();
    const double *a = x.data() + row.begin, *b = a + row.offset, *k = row.stiffness.data(), *l = row.rest_length.data(),
                 *dashpot = row.dashpot.data();
    double* block = blocks_[r].data();
    for (int p = 0; p < lanes; ++p) {
      const double dx = b[p] - a[p], dy = b[n + p] - a[n + p], dz = b[2 * n + p] - a[2 * n + p];
      const double r2 = dx * dx + dy * dy + dz * dz + kernels::smallest_square;
      const double stretched = 1.0 - l[p] / std::sqrt(r2), finite = stretched > lowest ? stretched : lowest;
      const double e = finite > 0 ? finite : softening * finite;
      const double c = (k[p] * (1.0 - e) + per_time * dashpot[p]) / r2, ke = k[p] * e;
      block[p] = c * dx * dx + ke;
      block[lanes + p] = c * dy * dy + ke;
      block[2 * lanes + p] = c * dz * dz + ke;
      block[3 * lanes + p] = c * dx * dy;
      block[4 * lanes + p] = c * dx * dz;
      block[5 * lanes + p] = c * dy * dz;
    }
    for (int c = 0; c < 6; ++c) {
      double *first = sums_.data() + c * n + row.begin, *second = first + row.offset;
      for (int p = 0; p < lanes; ++p) first[p] += block[c * lanes + p];
      for (int p = 0; p < lanes; ++p) second[p] += block[c * lanes + p];
    }
  }
}

void SpringHessian::subtract_product(const Springs& springs, const Points& u, Points& f) const {
  const int n = int(u.rows());
  for (std::size_t r = 0; r < springs.rows().size(); ++r) {
    const Springs::Row& row = springs.rows()[r];
    const int lanes = row.lanes();
    const double *a = u.data() + row.begin, *b = a + row.offset, *h = blocks_[r].data();
    double *first = f.data() + row.begin, *second = first + row.offset;
    double* push = springs.scratch();
    for (int p = 0; p < lanes; ++p) {
      const double dx = b[p] - a[p], dy = b[n + p] - a[n + p], dz = b[2 * n + p] - a[2 * n + p];
      push[p] = h[p] * dx + h[3 * lanes + p] * dy + h[4 * lanes + p] * dz;
      push[lanes + p] = h[3 * lanes + p] * dx + h[lanes + p] * dy + h[5 * lanes + p] * dz;
      push[2 * lanes + p] = h[4 * lanes + p] * dx + h[5 * lanes + p] * dy + h[2 * lanes + p] * dz;
    }
    for (int axis = 0; axis < 3; ++axis) {
      for (int p = 0; p < lanes; ++p) first[axis * n + p] += push[axis * lanes + p];
      for (int p = 0; p < lanes; ++p) second[axis * n + p] -= push[axis * lanes + p];
    }
  }
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
