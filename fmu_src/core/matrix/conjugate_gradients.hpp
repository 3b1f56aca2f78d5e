/// Symmetric positive definite matrices of lattices that are too wide for a factor (dissected_matrix.hpp): preconditioned conjugate
/// gradients (Hestenes & Stiefel 1952).
///
/// A = M/g^2 + D/g + K has rigid motions that a stiff body resists by its masses alone, (omega g)^2 times less than its fastest
/// vibrations. The preconditioner adds two solutions, that of the 3 x 3 blocks on the diagonal and that of a coarse lattice
/// (coarse_lattice.hpp), to which all slow motions belong: 25 to 50 iterations whatever the stiffness, where the blocks alone take 300.
///
/// It is over when the estimate r^T z of the error's energy norm has come down to `accuracy` of the solution's. `exact` is as good as a
/// factor for all that steps are used for: as A >= M/g^2, positions err by no more than so much of what they move.
///
/// A direction without positive curvature shows that the matrix is not positive definite: the result is NaN then, as with a factor, and
/// those who solve take less of what makes it indefinite. So it is where `most` iterations do not do.
#pragma once
#include "matrix/coarse_lattice.hpp"
#include "matrix/stencil_matrix.hpp"

namespace softffd {

class ConjugateGradients {
 public:
  static constexpr double exact = 1e-10;
  static constexpr int most = 400, usual = 30;  ///< iterations

  explicit ConjugateGradients(const Lattice& lattice);

  StencilMatrix matrix;
  /// To be called when the matrix has changed.
  void prepare();
  /// b <- A^-1 b, (points, 3). Returns the iterations that it took.
  int solve(Points& b, double accuracy);

 private:
  void invert_blocks();
  void precondition();

  CoarseLattice coarse_;
  Scalars inverse_;  ///< of the blocks on the diagonal, as xx yy zz xy xz yz, each (points)
  Points residual_, direction_, product_, preconditioned_;
};

}  // namespace softffd
