/// Symmetric positive definite matrices of a lattice, and solutions with them: by a factor for solids and narrow lattices
/// (dissected_matrix.hpp), by conjugate gradients for wide ones of springs (conjugate_gradients.hpp). Blocks couple points within one cell,
/// or nodes within one patch.
#pragma once
#include <optional>

#include "matrix/conjugate_gradients.hpp"
#include "matrix/dissected_matrix.hpp"

namespace softffd {

class LatticeMatrix {
 public:
  /// Most control points of springs in a plane across the longest axis for which there is a factor. Measured (AVX2): milliseconds a step of
  /// a cube that is pulled slowly (ros34pw2), and of one that slides down (backward_euler, 10 ms a step):
  ///
  ///      lattice                       8 x 8 x 8      9 x 9 x 9      12 x 12 x 12   16 x 16 x 16   32 x 32 x 4
  ///      factor                        4.5, 8.0       10, 13         32, 98         250, 370       110, 370
  ///      conjugate gradients                          5.2, 8.8       16, 42         52, 96         72, 340
  static constexpr int widest_factor = 64;

  /// Most nodes of a solid in such a plane for which there is a matrix at all: a factor of 19 x 19 x 19 takes a second, and conjugate
  /// gradients know no patches.
  static constexpr int widest_solid = 400;
  static bool exists(const Lattice& lattice) { return !lattice.lobatto || lattice.points_across() <= widest_solid; }

  static bool has_factor(const Lattice& lattice) { return lattice.lobatto || lattice.points_across() <= widest_factor; }

  explicit LatticeMatrix(const Lattice& lattice);

  void clear() { factor_ ? factor_->clear() : gradients_->matrix.clear(); }
  Mat3 block(int p, int q) const { return factor_ ? factor_->block(p, q) : gradients_->matrix.block(p, q); }
  /// Of two points; or of one, then symmetric. What it was before for (q, p) is its transpose.
  void set_block(int p, int q, const Mat3& block) { factor_ ? factor_->set_block(p, q, block) : gradients_->matrix.set_block(p, q, block); }
  void add_block(int p, int q, const Mat3& block) { factor_ ? factor_->add_block(p, q, block) : gradients_->matrix.add_block(p, q, block); }

  /// What solutions need, once the blocks are set; the factor takes their place.
  void factor() { factor_ ? factor_->factor() : gradients_->prepare(); }
  /// b <- A^-1 b, (points, 3); NaN if the matrix is not positive definite. accuracy: of conjugate gradients, which have it from them alone.
  /// Returns the work, in solutions as they usually are.
  double solve(Points& b, double accuracy = ConjugateGradients::exact);
  /// The same for several right sides, which a factor does faster.
  double solve_together(std::span<Points* const> sides);
  /// Number of right sides that cost as much as one.
  int sides_at_once() const { return factor_ ? int(DissectedMatrix::together) : 1; }

 private:
  std::optional<DissectedMatrix> factor_;
  std::optional<ConjugateGradients> gradients_;
};

}  // namespace softffd
