#include "matrix/spring_hessian.hpp"

#include <algorithm>
#include <cmath>

#include "machine/instructions.hpp"
#include "matrix/spring_assembly.hpp"

namespace softffd {

namespace kernels {

namespace loops {

/// Least 1 - l/r that counts: keeps the matrix of a spring without length finite.
constexpr double lowest = -1e6;

INNER void matrices(int lanes, double softening, double per_time, In x0, In y0, In z0, In x1, In y1, In z1, In k, In l, In dashpot, Out xx,
                    Out yy, Out zz, Out xy, Out xz, Out yz) {
  for (int p = 0; p < lanes; ++p) {
    const double dx = x1[p] - x0[p], dy = y1[p] - y0[p], dz = z1[p] - z0[p];
    const double r2 = dx * dx + dy * dy + dz * dz + smallest_square;
    const double stretched = 1.0 - l[p] / std::sqrt(r2), finite = stretched > lowest ? stretched : lowest;
    const double e = finite > 0 ? finite : softening * finite;
    const double c = (k[p] * (1.0 - e) + per_time * dashpot[p]) / r2, ke = k[p] * e;
    xx[p] = c * dx * dx + ke;
    yy[p] = c * dy * dy + ke;
    zz[p] = c * dz * dz + ke;
    xy[p] = c * dx * dy;
    xz[p] = c * dx * dz;
    yz[p] = c * dy * dz;
  }
}

INNER void add(int lanes, In block, Out sum) {
  for (int p = 0; p < lanes; ++p) sum[p] += block[p];
}

INNER void subtract(int lanes, In push, Out f) {
  for (int p = 0; p < lanes; ++p) f[p] -= push[p];
}

/// Matrices of a row's springs at x, (6 * lanes), and their sums at the points, (6 * points).
INNER void add_matrices(const SpringRow& springs, const double* dashpot, int points, const double* x, double softening, double per_time,
                        double* block, double* sums) {
  const int lanes = springs.lanes;
  const double *a = x + springs.begin, *b = a + springs.offset;
  matrices(lanes, softening, per_time, a, a + points, a + 2 * points, b, b + points, b + 2 * points, springs.stiffness, springs.rest_length,
           dashpot, block, block + lanes, block + 2 * lanes, block + 3 * lanes, block + 4 * lanes, block + 5 * lanes);
  for (int c = 0; c < 6; ++c) {
    double* first = sums + c * points + springs.begin;
    add(lanes, block + c * lanes, first);
    add(lanes, block + c * lanes, first + springs.offset);
  }
}

INNER void pushes(int lanes, In x0, In y0, In z0, In x1, In y1, In z1, In xx, In yy, In zz, In xy, In xz, In yz, Out px, Out py, Out pz) {
  for (int p = 0; p < lanes; ++p) {
    const double dx = x1[p] - x0[p], dy = y1[p] - y0[p], dz = z1[p] - z0[p];
    px[p] = xx[p] * dx + xy[p] * dy + xz[p] * dz;
    py[p] = xy[p] * dx + yy[p] * dy + yz[p] * dz;
    pz[p] = xz[p] * dx + yz[p] * dy + zz[p] * dz;
  }
}

/// f -= K u for a row's springs; scratch (3 * lanes).
INNER void subtract_row(const SpringRow& springs, int points, const double* u, const double* block, double* scratch, double* f) {
  const int lanes = springs.lanes;
  const double *a = u + springs.begin, *b = a + springs.offset;
  pushes(lanes, a, a + points, a + 2 * points, b, b + points, b + 2 * points, block, block + lanes, block + 2 * lanes, block + 3 * lanes,
         block + 4 * lanes, block + 5 * lanes, scratch, scratch + lanes, scratch + 2 * lanes);
  for (int axis = 0; axis < 3; ++axis) {
    double* first = f + axis * points + springs.begin;
    add(lanes, scratch + axis * lanes, first);
    subtract(lanes, scratch + axis * lanes, first + springs.offset);
  }
}

}  // namespace loops

const auto add_matrices = chosen<loops::add_matrices>();
const auto subtract_row = chosen<loops::subtract_row>();

}  // namespace kernels

/// Large lattices that never solve are spared the memory: it is first touched by `compute`.
SpringHessian::SpringHessian(int points) : blocks_(directions.size()), sums_(6 * points) {
  for (Scalars& blocks : blocks_) blocks.resize(6 * points);
}

void SpringHessian::compute(const Springs& springs, const Points& x, double softening, double per_time) {
  sums_.setZero();
  for (std::size_t r = 0; r < springs.rows().size(); ++r) {
    const Springs::Row& row = springs.rows()[r];
    kernels::add_matrices(row.view(), row.dashpot.data(), int(x.rows()), x.data(), softening, per_time, blocks_[r].data(), sums_.data());
  }
}

void SpringHessian::subtract_product(const Springs& springs, const Points& u, Points& f) const {
  for (std::size_t r = 0; r < springs.rows().size(); ++r)
    kernels::subtract_row(springs.rows()[r].view(), int(u.rows()), u.data(), blocks_[r].data(), springs.scratch(), f.data());
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
