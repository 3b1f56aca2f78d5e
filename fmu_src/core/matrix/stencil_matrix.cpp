#include "matrix/stencil_matrix.hpp"

#include <algorithm>

#include "matrix/stencil_loops.hpp"

namespace softffd {

namespace {

/// Number of points in one pass of a product: the blocks of a direction stay in the first cache until both of its products are done.
constexpr int tile = 256;

}  // namespace

StencilMatrix::StencilMatrix(const Lattice& lattice) : points_(lattice.points()), diagonal_(6 * points_) {
  for (std::size_t d = 0; d < directions.size(); ++d) {
    offsets_[d] = directions[d].offset(lattice);
    couplings_[d].resize(9 * lanes(int(d)));
  }
}

void StencilMatrix::clear() {
  for (Scalars& blocks : couplings_) blocks.setZero();
  diagonal_.setZero();
}

int StencilMatrix::direction(int offset) const { return int(std::find(offsets_.begin(), offsets_.end(), offset) - offsets_.begin()); }

Mat3 StencilMatrix::coupling(int direction, int p) const {
  Mat3 block;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) block(a, b) = couplings_[direction][(3 * a + b) * lanes(direction) + p];
  return block;
}

Mat3 StencilMatrix::block(int p, int q) const {
  if (p < q) return coupling(direction(q - p), p);
  if (p > q) return coupling(direction(p - q), q).transpose();
  Mat3 own;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) own(a, b) = diagonal_[component[a][b] * points_ + p];
  return own;
}

template <class Change>
void StencilMatrix::change(int p, int q, const Mat3& block, Change change) {
  if (p == q) {
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b <= a; ++b) change(diagonal_[component[a][b] * points_ + p], block(a, b));
    return;
  }
  const int first = std::min(p, q), d = direction(std::abs(q - p));
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) change(couplings_[d][(3 * a + b) * lanes(d) + first], p < q ? block(a, b) : block(b, a));
}

void StencilMatrix::set_block(int p, int q, const Mat3& block) {
  change(p, q, block, [](double& entry, double value) { entry = value; });
}

void StencilMatrix::add_block(int p, int q, const Mat3& block) {
  change(p, q, block, [](double& entry, double value) { entry += value; });
}

void StencilMatrix::multiply(const Points& x, Points& y) const {
  kernels::symmetric_products(points_, points_, points_, diagonal_.data(), x.data(), y.data());
  for (int begin = 0; begin < points_; begin += tile)
    for (std::size_t d = 0; d < offsets_.size(); ++d) {
      const int offset = offsets_[d], n = std::min(tile, lanes(int(d)) - begin);
      if (n <= 0) continue;
      const double* blocks = couplings_[d].data() + begin;
      kernels::add_products(n, lanes(int(d)), points_, blocks, x.data() + begin + offset, y.data() + begin);
      kernels::add_transposed_products(n, lanes(int(d)), points_, blocks, x.data() + begin, y.data() + begin + offset);
    }
}

}  // namespace softffd
