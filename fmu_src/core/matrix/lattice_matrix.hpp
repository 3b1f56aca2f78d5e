/// Symmetric positive definite matrices of a lattice, and solutions with them: by a factor where layers are narrow (layer_matrix.hpp), by
/// conjugate gradients where they are wide (conjugate_gradients.hpp). Blocks couple points within one cell, or nodes within one patch.
#pragma once
#include <optional>

#include "matrix/conjugate_gradients.hpp"
#include "matrix/layer_matrix.hpp"

namespace softffd {

class LatticeMatrix {
 public:
  /// Most control points in a layer for which there is a factor. Measured for a cube pulled slowly, ros34pw2 at tolerances of 1e-4 and
  /// 1e-6, which take 22 and 55 steps with half as many matrices, and for a solution with a matrix of its own, as contact wants them:
  ///
  ///      lattice                     8 x 8 x 8      9 x 9 x 9      10 x 10 x 10   11 x 11 x 11   32 x 32 x 4
  ///      run, factor [s]             0.11, 0.22     0.21, 0.50     0.41, 0.87     0.73, 1.92     2.90, 6.97
  ///      conjugate gradients         0.11, 0.23     0.15, 0.30     0.21, 0.43     0.28, 0.60     1.39, 2.84
  ///      solution, factor [ms]       3.6            9              19             38             140
  ///      conjugate gradients         1.9            2.8            4.5            6              28
  static constexpr int widest_factor = 64;

  /// Most nodes of a solid in a layer for which there is a matrix at all: conjugate gradients know no patches.
  static constexpr int widest_solid = 320;
  static bool exists(const Lattice& lattice) { return !lattice.lobatto || LayerMatrix::points_per_layer(lattice) <= widest_solid; }

  explicit LatticeMatrix(const Lattice& lattice);

  void clear() { layers_ ? layers_->clear() : gradients_->matrix.clear(); }
  Mat3 block(int p, int q) const { return layers_ ? layers_->block(p, q) : gradients_->matrix.block(p, q); }
  /// Of two points; or of one, then symmetric. What it was before for (q, p) is its transpose.
  void set_block(int p, int q, const Mat3& block) { layers_ ? layers_->set_block(p, q, block) : gradients_->matrix.set_block(p, q, block); }
  void add_block(int p, int q, const Mat3& block) { layers_ ? layers_->add_block(p, q, block) : gradients_->matrix.add_block(p, q, block); }

  /// What solutions need, once the blocks are set; the factor takes their place.
  void factor() { layers_ ? layers_->factor() : gradients_->prepare(); }
  /// b <- A^-1 b, (points, 3); NaN if the matrix is not positive definite. accuracy: of conjugate gradients, which have it from them alone.
  /// Returns the work, in solutions as they usually are.
  double solve(Points& b, double accuracy = ConjugateGradients::exact);
  /// The same for several right sides, which a factor does faster.
  double solve_together(std::span<Points* const> sides);

 private:
  std::optional<LayerMatrix> layers_;
  std::optional<ConjugateGradients> gradients_;
};

}  // namespace softffd
