/// Symmetric positive definite matrices of a lattice, and solutions with them. Solids and narrow lattices use a factor
/// (dissected_matrix.hpp), wide lattices of springs use conjugate gradients (conjugate_gradients.hpp). Blocks couple points within one
/// cell, or nodes within one patch.
#pragma once
#include <optional>

#include "matrix/conjugate_gradients.hpp"
#include "matrix/dissected_matrix.hpp"

namespace softffd {

class LatticeMatrix {
 public:
  /// Largest number of control points in a plane across the longest axis for which a lattice of springs uses a factor. Measured (AVX2):
  /// milliseconds per step for a cube that is pulled slowly (ros34pw2), and for one that slides down (backward_euler, steps of 10 ms):
  ///
  ///      lattice                       8 x 8 x 8      9 x 9 x 9      12 x 12 x 12   16 x 16 x 16   32 x 32 x 4
  ///      factor                        4.5, 8.0       10, 13         32, 98         250, 370       110, 370
  ///      conjugate gradients                          5.2, 8.8       16, 42         52, 96         72, 340
  static constexpr int widest_factor = 64;

  /// Largest number of nodes of a solid in such a plane for which there is a matrix at all: a factor of 19 x 19 x 19 nodes takes a second,
  /// and conjugate gradients do not support patches.
  static constexpr int widest_solid = 400;
  static bool exists(const Lattice& lattice) { return !lattice.lobatto || lattice.points_across() <= widest_solid; }

  static bool has_factor(const Lattice& lattice) { return lattice.lobatto || lattice.points_across() <= widest_factor; }

  explicit LatticeMatrix(const Lattice& lattice);

  void clear() { factor_ ? factor_->clear() : gradients_->matrix.clear(); }
  Mat3 block(int p, int q) const { return factor_ ? factor_->block(p, q) : gradients_->matrix.block(p, q); }
  /// Sets the block of two points, or the symmetric block of one point. Block (q, p) is its transpose.
  void set_block(int p, int q, const Mat3& block) { factor_ ? factor_->set_block(p, q, block) : gradients_->matrix.set_block(p, q, block); }
  void add_block(int p, int q, const Mat3& block) { factor_ ? factor_->add_block(p, q, block) : gradients_->matrix.add_block(p, q, block); }

  /// Prepares solutions, once the blocks are set. A factor overwrites the blocks.
  void factor() { factor_ ? factor_->factor() : gradients_->prepare(); }
  /// b <- A^-1 b, (points, 3); NaN if the matrix is not positive definite. accuracy: of conjugate gradients; a factor ignores it. Returns
  /// the work, in units of a usual solution.
  double solve(Points& b, double accuracy = ConjugateGradients::exact);
  /// The same for several right-hand sides, which is faster with a factor.
  double solve_together(std::span<Points* const> sides);
  /// Returns the number of right-hand sides that are solved for together.
  int sides_at_once() const { return factor_ ? int(DissectedMatrix::together) : 1; }

 private:
  std::optional<DissectedMatrix> factor_;
  std::optional<ConjugateGradients> gradients_;
};

}  // namespace softffd
