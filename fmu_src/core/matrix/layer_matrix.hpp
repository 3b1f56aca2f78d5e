/// Symmetric positive definite matrices of the lattice: every point meets its neighbours within one cell, so that with the points counted
/// layer by layer the matrix is block tridiagonal, and so is its Cholesky factor. Nodes of a solid meet those of their patches: a layer is
/// three planes of them, from the beginning of a patch to before the next, and the last one plane, whose blocks are narrower.
///
/// Layers are taken across the axis with the most points (the last of those with as many), which makes them smallest. Unknowns run layer by
/// layer; inside a layer first the x of all its points, then y, then z, points in the order of their flat index. Each layer is padded
/// to one multiple of eight unknowns, with ones on the diagonal. The lower triangle is stored by columns of one length; a column of layer L
/// holds the rows of layers L and L + 1:
///
///        layer   0   1   2   3
///          0   [ D                 ]
///          1   [ B   D             ]        column of layer 1:  | D | B |, D from the top of the layer, B below it
///          2   [     B   D         ]
///          3   [         B   D     ]        the last layer's B is not used
///
/// For layers of s unknowns factoring takes 7/3 s^3 multiplications a layer, solving 3 s^2, and 16 s^2 bytes: 2.4 MB for 8 x 8 x 8 points,
/// 20 MB for 8 x 8 x 32, but 150 MB for 16 x 16 x 16 and 5 GB for 32 x 32 x 32, where lattice_matrix.hpp has another way. The loops are
/// panels.hpp's: same bits on every instruction set.
#pragma once
#include <memory>
#include <span>
#include <vector>

#include "forces/blocks.hpp"
#include "model/lattice.hpp"

namespace softffd {

class LayerMatrix {
 public:
  static int points_per_layer(const Lattice& lattice);

  /// Memory is taken here and first touched by `clear`.
  explicit LayerMatrix(const Lattice& lattice);

  void clear();
  /// Entry of coordinates a of point p and b of point q; both in one layer or in layers next to each other. The lower triangle alone is
  /// stored: (p, a, q, b) and (q, b, p, a) are one.
  double& at(int p, int a, int q, int b) { return values_[place(p, a, q, b)]; }
  Mat3 block(int p, int q) const;
  /// Of two points; or of one, then symmetric.
  void set_block(int p, int q, const Mat3& block) {
    visit(p, q, [&](int a, int b, double& entry) { entry = block(a, b); });
  }
  void add_block(int p, int q, const Mat3& block) {
    visit(p, q, [&](int a, int b, double& entry) { entry += block(a, b); });
  }
  /// Index of coordinate a of point p among the unknowns.
  int unknown(int p, int a) const { return first_[p] + a * points_in_layer(p); }

  /// Cholesky factor in place. Of a matrix that is not positive definite to rounding it has NaN in it.
  void factor();
  /// b <- A^-1 b, (points, 3), with the factor.
  void solve(Points& b);
  /// The same for up to `together` right sides, whose bits do not depend on which ones come together.
  static constexpr std::size_t together = 8;
  void solve_together(std::span<Points* const> sides);

  int layers() const { return layers_; }
  /// Axis that the layers lie across.
  int axis() const { return axis_; }

 private:
  struct Free {
    void operator()(double* values) const;
  };
  std::size_t place(int p, int a, int q, int b) const {
    const int i = unknown(p, a), j = unknown(q, b);
    return i < j ? column_[p] + a * points_in_layer(p) * stride_ + j : column_[q] + b * points_in_layer(q) * stride_ + i;
  }
  /// Every entry of a block once. Where the points are in two layers all are in the columns of one of them: which is asked once a block.
  template <class Visit>
  void visit(int p, int q, Visit visit) {
    const int n = points_per_layer_, n_p = points_in_layer(p), n_q = points_in_layer(q), i = first_[p], j = first_[q];
    double *of_p = values_.get() + column_[p] + j, *of_q = values_.get() + column_[q] + i;
    const auto each = [&](auto is_below, auto is_wanted) {
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
          if (is_wanted(a, b)) visit(a, b, is_below(a, b) ? of_p[a * n_p * stride_ + b * n_q] : of_q[b * n_q * stride_ + a * n_p]);
    };
    const auto always = [](int, int) { return true; };
    if (j - i >= n)
      each(always, always);
    else if (i - j >= n)
      each([](int, int) { return false; }, always);
    else if (i < j)
      each([](int a, int b) { return a <= b; }, always);
    else
      each([](int a, int b) { return a < b; }, [same = i == j](int a, int b) { return !same || b <= a; });
  }
  double* layer(int layer) { return values_.get() + std::size_t(layer) * size_ * stride_; }
  int points_in_layer(int p) const { return points_[first_[p] / size_]; }
  /// Unknowns of a layer with padding.
  int columns(int layer) const { return padded(3 * points_[layer]); }
  int rows(int layer) const { return layer + 1 < layers_ ? size_ + columns(layer + 1) : columns(layer); }
  static int padded(int unknowns);

  int axis_, planes_per_layer_, layers_, points_per_layer_, size_;  ///< size: unknowns of the first layers with padding
  std::size_t stride_;                                              ///< between columns
  std::vector<int> first_;                                          ///< (points) unknown of the x coordinate
  std::vector<int> points_;                                         ///< of each layer
  std::vector<std::size_t> column_;                                 ///< (points) where the column of the x coordinate would have row 0
  std::unique_ptr<double[], Free> values_;                          ///< columns
  Scalars inverse_diagonal_, vector_;                               ///< (unknowns)
  Scalars vectors_;                                                 ///< (together, unknowns), from the first time on that they are wanted
};

}  // namespace softffd
