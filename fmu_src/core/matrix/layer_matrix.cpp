#include "matrix/layer_matrix.hpp"

#include <algorithm>
#include <new>

#include "matrix/panels.hpp"

namespace softffd {

namespace {

constexpr std::align_val_t cache_line{64};
constexpr int width = kernels::block;

int axis_with_most_points(const Lattice& lattice) {
  const auto& n = lattice.counts;
  return n[2] >= n[0] && n[2] >= n[1] ? 2 : n[1] >= n[0] ? 1 : 0;
}

/// A patch has three planes of nodes and the first of the next.
int planes_of_layer(const Lattice& lattice) { return lattice.lobatto ? 3 : 1; }

}  // namespace

int LayerMatrix::points_per_layer(const Lattice& lattice) {
  return planes_of_layer(lattice) * (lattice.points() / lattice.counts[axis_with_most_points(lattice)]);
}

int LayerMatrix::padded(int unknowns) { return (unknowns + width - 1) / width * width; }

void LayerMatrix::Free::operator()(double* values) const { ::operator delete[](values, cache_line); }

LayerMatrix::LayerMatrix(const Lattice& lattice)
    : axis_(axis_with_most_points(lattice)),
      planes_per_layer_(planes_of_layer(lattice)),
      layers_((lattice.counts[axis_] + planes_per_layer_ - 1) / planes_per_layer_),
      points_per_layer_(points_per_layer(lattice)),
      size_(padded(3 * points_per_layer_)),
      points_(layers_, 0) {
  stride_ = 2 * size_ + width;  // the spare width keeps columns of large lattices off each other's cache sets
  const std::size_t unknowns = std::size_t(layers_) * size_;
  values_.reset(static_cast<double*>(::operator new[](unknowns * stride_ * sizeof(double), cache_line)));
  inverse_diagonal_ = vector_ = Scalars::Zero(unknowns);
  first_.resize(lattice.points());
  column_.resize(lattice.points());
  for (int k = 0; k < lattice.counts[2]; ++k)
    for (int j = 0; j < lattice.counts[1]; ++j)
      for (int i = 0; i < lattice.counts[0]; ++i) {
        const int layer = (axis_ == 0 ? i : axis_ == 1 ? j : k) / planes_per_layer_;
        const int unknown = layer * size_ + points_[layer]++, p = lattice.index(i, j, k);
        first_[p] = unknown;
        column_[p] = unknown * stride_ - layer * size_;
      }
}

void LayerMatrix::clear() {
  for (int l = 0; l < layers_; ++l)
    for (int j = 0; j < columns(l); ++j) {
      double* column = layer(l) + j * stride_;
      std::fill(column + j / width * width, column + rows(l), 0.0);  // what is above the diagonal's panel has no meaning
    }
  vector_.setZero();  // the padding may hold NaN of a matrix that was not positive definite
  for (int l = 0; l < layers_; ++l)
    for (int i = 3 * points_[l]; i < columns(l); ++i) layer(l)[i * stride_ + i] = 1;
}

Mat3 LayerMatrix::block(int p, int q) const {
  Mat3 block;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) block(a, b) = values_[place(p, a, q, b)];
  return block;
}

void LayerMatrix::factor() {
  for (int l = 0; l < layers_; ++l) {
    double* here = layer(l);
    for (int j = 0; j < columns(l); j += width) {
      double* panel = here + j * stride_ + j;
      const int blocks = (rows(l) - j) / width;
      if (l > 0) kernels::subtract_products((columns(l) - j) / width, size_, stride_, layer(l - 1) + size_ + j, panel);
      kernels::subtract_products(blocks, j, stride_, here + j, panel);
      kernels::factor_panel(blocks, stride_, panel, inverse_diagonal_.data() + l * size_ + j);
    }
  }
}

void LayerMatrix::solve(Points& b) {
  const int points = int(b.rows());
  for (int a = 0; a < 3; ++a)
    for (int p = 0; p < points; ++p) vector_[unknown(p, a)] = b(p, a);
  for (int l = 0, i = 0; l < layers_; ++l, i += size_)
    kernels::solve_lower(columns(l), rows(l), stride_, layer(l), inverse_diagonal_.data() + i, vector_.data() + i);
  for (int l = layers_ - 1, i = l * size_; l >= 0; --l, i -= size_)
    kernels::solve_upper(columns(l), rows(l), stride_, layer(l), inverse_diagonal_.data() + i, vector_.data() + i);
  for (int a = 0; a < 3; ++a)
    for (int p = 0; p < points; ++p) b(p, a) = vector_[unknown(p, a)];
}

void LayerMatrix::solve_together(std::span<Points* const> sides) {
  static_assert(together == kernels::block);
  vectors_ = Scalars::Zero(vector_.size() * together);
  const auto visit = [&](auto take) {
    for (int a = 0; a < 3; ++a)
      for (int p = 0; p < int(first_.size()); ++p) {
        double* together_at = &vectors_[unknown(p, a) * Eigen::Index(together)];
        for (std::size_t s = 0; s < sides.size(); ++s) take((*sides[s])(p, a), together_at[s]);
      }
  };
  visit([](double from, double& to) { to = from; });
  for (int l = 0, i = 0; l < layers_; ++l, i += size_)
    kernels::solve_lower_together(columns(l), rows(l), stride_, layer(l), inverse_diagonal_.data() + i, vectors_.data() + i * together);
  for (int l = layers_ - 1, i = l * size_; l >= 0; --l, i -= size_)
    kernels::solve_upper_together(columns(l), rows(l), stride_, layer(l), inverse_diagonal_.data() + i, vectors_.data() + i * together);
  visit([](double& to, double from) { to = from; });
}

}  // namespace softffd
