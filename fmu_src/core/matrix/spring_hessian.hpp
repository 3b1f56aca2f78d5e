/// The exact second derivatives of the springs' energy, one 3 x 3 matrix a spring,
///
///      k (u u^T + e (I - u u^T)),  e = 1 - l/r,      u: unit vector along the spring, r its length, l its rest length.
///
/// A compressed spring has e < 0, which softens it across and may make their sum indefinite: of this softening a share is taken. With 1
/// the matrices are exact. With 0 each is the nearest positive semidefinite bound, with which Newton's method converges slowly under
/// compression: the same matrix as stiffness_matrix.hpp's, which is multiplied in another order, faster where it is used once.
#pragma once
#include "body/body.hpp"
#include "matrix/lattice_matrix.hpp"

namespace softffd {

class SpringHessian {
 public:
  explicit SpringHessian(int points);

  /// Matrices of all springs at x [m], and of their dashpots per_time [1/s]: c u u^T. softening: the share of it, from 0 to 1.
  void compute(const Springs& springs, const Points& x, double softening, double per_time = 0);
  /// f -= K u [N]; u [m].
  void subtract_product(const Springs& springs, const Points& u, Points& f) const;
  /// matrix = K + diagonal, diagonal (points) [N/m]; rows and columns of pinned points are those of the identity.
  void fill(const Body& body, const Scalars& diagonal, LatticeMatrix& matrix) const;

 private:
  std::vector<Scalars> blocks_;  ///< (rows)(6 * lanes): xx yy zz xy xz yz
  Scalars sums_;                 ///< (6 * points): of all springs at a point
};

}  // namespace softffd
