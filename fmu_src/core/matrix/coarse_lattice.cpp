#include "matrix/coarse_lattice.hpp"

#include <algorithm>

namespace softffd {

namespace {

/// Smallest spacing of the nodes along an axis, in points; larger where layers of the coarse matrix would be wider than `widest`. Measured
/// on 16 x 16 x 16: spacing 3 takes 27 iterations; spacing 2 takes 20, but its coarse matrix takes seven times the time.
constexpr int least_spacing = 3;
/// Largest number of nodes in a layer of the coarse matrix: a solution on 8 x 8 x 8 takes as long as a matrix product on 16 x 16 x 16.
constexpr int widest = 64;

constexpr int neighbours = 27;  ///< of a node, including the node itself
constexpr int code(int i, int j, int k) { return i + 3 * (j + 3 * k); }

/// An array of outer x n x inner values; `gather` and `spread` work along its middle axis.
struct Shape {
  int outer, n, inner;
};

/// Restriction along one axis with `count` nodes: nodes = P^T points.
void restrict_along(const Shape& shape, int count, const int* cell, const double* weight, const double* points, double* nodes) {
  std::fill_n(nodes, std::size_t(shape.outer) * count * shape.inner, 0.0);
  for (int o = 0; o < shape.outer; ++o, nodes += count * shape.inner)
    for (int i = 0; i < shape.n; ++i, points += shape.inner) {
      double *before = nodes + cell[i] * shape.inner, *after = before + shape.inner;
      const double s = weight[i], rest = 1 - s;
      for (int j = 0; j < shape.inner; ++j) before[j] += rest * points[j];
      for (int j = 0; j < shape.inner; ++j) after[j] += s * points[j];
    }
}

/// Prolongation along one axis with `count` nodes: points = P nodes, or points += P nodes if `add`.
template <bool add>
void prolong_along(const Shape& shape, int count, const int* cell, const double* weight, const double* nodes, double* points) {
  for (int o = 0; o < shape.outer; ++o, nodes += count * shape.inner)
    for (int i = 0; i < shape.n; ++i, points += shape.inner) {
      const double *before = nodes + cell[i] * shape.inner, *after = before + shape.inner;
      const double s = weight[i], rest = 1 - s;
      for (int j = 0; j < shape.inner; ++j) points[j] = (add ? points[j] : 0.0) + (rest * before[j] + s * after[j]);
    }
}

}  // namespace

Lattice CoarseLattice::coarsened(const Lattice& fine) {
  Lattice coarse = fine;
  for (int spacing = least_spacing;; ++spacing) {
    for (int a = 0; a < 3; ++a) coarse.counts[a] = (fine.counts[a] - 2 + spacing) / spacing + 1;
    if (coarse.points_across() <= widest) return coarse;
  }
}

CoarseLattice::CoarseLattice(const Lattice& fine)
    : fine_(fine),
      coarse_(coarsened(fine)),
      products_(neighbours * coarse_.points()),
      matrix_(coarse_),
      nodes_(coarse_.points(), 3),
      between_(fine.counts[0] * fine.counts[1] * coarse_.counts[2]),
      between_two_(fine.counts[0] * coarse_.counts[1] * coarse_.counts[2]) {
  for (int a = 0; a < 3; ++a) {
    const int n = fine.counts[a], cells = coarse_.counts[a] - 1;
    const auto place = [&](int node) { return (node * (n - 1) + cells / 2) / cells; };
    for (int i = 0, cell = 0; i < n; ++i) {
      if (cell + 1 < cells && place(cell + 1) <= i) ++cell;
      axes_[a].cell.push_back(cell);
      axes_[a].weight.push_back(double(i - place(cell)) / (place(cell + 1) - place(cell)));
    }
  }
  weigh_points();
}

void CoarseLattice::weigh_points() {
  const auto& [x, y, z] = axes_;
  for (int k = 0; k < fine_.counts[2]; ++k)
    for (int j = 0; j < fine_.counts[1]; ++j)
      for (int i = 0; i < fine_.counts[0]; ++i) {
        first_.push_back(int(weights_.size()));
        for (int corner = 0; corner < 8; ++corner) {
          const int a = corner & 1, b = corner >> 1 & 1, c = corner >> 2;
          const auto part = [](const Axis& axis, int at, int side) { return side ? axis.weight[at] : 1 - axis.weight[at]; };
          const double value = part(x, i, a) * part(y, j, b) * part(z, k, c);
          const int at[] = {x.cell[i] + a, y.cell[j] + b, z.cell[k] + c};
          if (value > 0) weights_.push_back({coarse_.index(at[0], at[1], at[2]), code(at[0], at[1], at[2]), value});
        }
      }
  first_.push_back(int(weights_.size()));
}

/// Adds the contribution of the block (p, q) to products_. The contribution of the block (q, p) is its mirror image, which `factor` adds.
void CoarseLattice::add_pair(int p, int q, const Mat3& block) {
  for (int i = first_[p]; i < first_[p + 1]; ++i) {
    const Weight& here = weights_[i];
    Mat3* const row = products_.data() + neighbours * here.node + neighbours / 2 - here.code;
    for (int j = first_[q]; j < first_[q + 1]; ++j) {
      const double weight = here.value * weights_[j].value;
      double* product = row[weights_[j].code].data();
      for (int c = 0; c < 9; ++c) product[c] += weight * block.data()[c];
    }
  }
}

void CoarseLattice::factor(const StencilMatrix& matrix) {
  std::fill(products_.begin(), products_.end(), Mat3::Zero());
  for (int p = 0; p < fine_.points(); ++p) add_pair(p, p, 0.5 * matrix.block(p, p));
  matrix.visit_couplings([&](int p, int q, const Mat3& block) { add_pair(p, q, block); });
  matrix_.clear();
  const auto& m = coarse_.counts;
  const auto product = [&](int node, int direction) { return products_[neighbours * node + neighbours / 2 + direction]; };
  for (int k = 0; k < m[2]; ++k)
    for (int j = 0; j < m[1]; ++j)
      for (int i = 0; i < m[0]; ++i) {
        const int here = coarse_.index(i, j, k);
        matrix_.set_block(here, here, product(here, 0) + product(here, 0).transpose());
        for (const Direction& d : directions) {
          if (!d.within(coarse_, i, j, k)) continue;
          const int there = here + d.offset(coarse_), direction = code(d.di, d.dj, d.dk);
          matrix_.set_block(here, there, product(here, direction) + product(there, -direction).transpose());
        }
      }
  matrix_.factor();
}

void CoarseLattice::add_correction(const Points& r, Points& z) {
  const auto& n = fine_.counts;
  const auto& m = coarse_.counts;
  const Shape along_z{1, n[2], n[0] * n[1]}, along_y{m[2], n[1], n[0]}, along_x{m[2] * m[1], n[0], 1};
  for (int a = 0; a < 3; ++a) {
    restrict_along(along_z, m[2], axes_[2].cell.data(), axes_[2].weight.data(), r.col(a).data(), between_.data());
    restrict_along(along_y, m[1], axes_[1].cell.data(), axes_[1].weight.data(), between_.data(), between_two_.data());
    restrict_along(along_x, m[0], axes_[0].cell.data(), axes_[0].weight.data(), between_two_.data(), nodes_.col(a).data());
  }
  matrix_.solve(nodes_);
  for (int a = 0; a < 3; ++a) {
    prolong_along<false>(along_x, m[0], axes_[0].cell.data(), axes_[0].weight.data(), nodes_.col(a).data(), between_two_.data());
    prolong_along<false>(along_y, m[1], axes_[1].cell.data(), axes_[1].weight.data(), between_two_.data(), between_.data());
    prolong_along<true>(along_z, m[2], axes_[2].cell.data(), axes_[2].weight.data(), between_.data(), z.col(a).data());
  }
}

}  // namespace softffd
