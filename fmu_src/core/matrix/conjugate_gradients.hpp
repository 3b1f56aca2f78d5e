/// Preconditioned conjugate gradients (Hestenes & Stiefel 1952) for symmetric positive definite matrices of lattices that are too wide for
/// a factor (dissected_matrix.hpp).
///
/// In A = M/g^2 + D/g + K only the masses resist rigid motions; in a stiff body they do so (omega g)^2 times less than the body resists
/// its fastest vibrations. The preconditioner adds two solutions: one with the 3 x 3 blocks on the diagonal, one with a coarse lattice
/// (coarse_lattice.hpp), which contains all slow motions. It takes 25 to 50 iterations whatever the stiffness; the blocks alone take 300.
///
/// The iteration ends when the estimate r^T z of the error's energy norm has fallen to the fraction `accuracy` of that of the solution.
/// For all uses in a step, `exact` is as good as a factor: because A >= M/g^2, positions err by no more than this fraction of their
/// displacement.
///
/// If a search direction has no positive curvature, the matrix is not positive definite. The result is then NaN, as with a factor, and
/// callers reduce the part that makes the matrix indefinite. The result is also NaN if `most` iterations are not enough.
#pragma once
#include "matrix/coarse_lattice.hpp"
#include "matrix/stencil_matrix.hpp"

namespace softffd {

class ConjugateGradients {
 public:
  static constexpr double exact = 1e-10;
  static constexpr int most = 400, usual = 30;  ///< largest and usual number of iterations

  explicit ConjugateGradients(const Lattice& lattice);

  StencilMatrix matrix;
  /// Prepares the preconditioner; call when the matrix has changed.
  void prepare();
  /// b <- A^-1 b, (points, 3). Returns the number of iterations.
  int solve(Points& b, double accuracy);

 private:
  void invert_blocks();
  void precondition();

  CoarseLattice coarse_;
  Scalars inverse_;  ///< inverses of the blocks on the diagonal, as xx yy zz xy xz yz, each (points)
  Points residual_, direction_, product_, preconditioned_;
};

}  // namespace softffd
