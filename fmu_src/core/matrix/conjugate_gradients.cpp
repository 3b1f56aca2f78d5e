#include "matrix/conjugate_gradients.hpp"

#include <limits>

#include "forces/kernels.hpp"
#include "matrix/stencil_loops.hpp"

namespace softffd {

namespace {

/// sum = x + c y; sum may be x or y.
void add(const Points& x, double c, const Points& y, Points& sum) {
  const double* array = y.data();
  kernels::combine(x.size(), x.data(), 1, &c, &array, sum.data());
}

}  // namespace

ConjugateGradients::ConjugateGradients(const Lattice& lattice) : matrix(lattice), coarse_(lattice), inverse_(6 * lattice.points()) {
  for (Points* points : {&residual_, &direction_, &product_, &preconditioned_}) points->setZero(lattice.points(), 3);
}

void ConjugateGradients::prepare() {
  invert_blocks();
  coarse_.factor(matrix);
}

/// Inverts the diagonal blocks by their cofactors; the inverse is NaN if a block is not positive definite.
void ConjugateGradients::invert_blocks() {
  const int n = int(residual_.rows());
  const double* s = matrix.diagonal().data();
  for (int p = 0; p < n; ++p) {
    const double xx = s[p], yy = s[n + p], zz = s[2 * n + p], xy = s[3 * n + p], xz = s[4 * n + p], yz = s[5 * n + p];
    const double cofactors[6] = {yy * zz - yz * yz, xx * zz - xz * xz, xx * yy - xy * xy,
                                 xz * yz - xy * zz, xy * yz - xz * yy, xy * xz - xx * yz};
    const double determinant = xx * cofactors[0] + xy * cofactors[3] + xz * cofactors[4];
    const bool positive = xx > 0 && cofactors[2] > 0 && determinant > 0;
    const double scale = positive ? 1 / determinant : std::numeric_limits<double>::quiet_NaN();
    for (int c = 0; c < 6; ++c) inverse_[c * n + p] = scale * cofactors[c];
  }
}

void ConjugateGradients::precondition() {
  const std::size_t n = residual_.rows();
  kernels::symmetric_products(int(n), n, n, inverse_.data(), residual_.data(), preconditioned_.data());
  coarse_.add_correction(residual_, preconditioned_);
}

int ConjugateGradients::solve(Points& b, double accuracy) {
  const std::size_t n = b.size();
  residual_ = b;
  b.setZero();
  precondition();
  direction_ = preconditioned_;
  double left = kernels::dot(n, residual_.data(), preconditioned_.data()), energy = 0;
  if (left == 0) return 0;
  for (int i = 1; i <= most; ++i) {
    matrix.multiply(direction_, product_);
    const double curvature = kernels::dot(n, direction_.data(), product_.data());
    if (!(curvature > 0 && left > 0)) break;
    const double step = left / curvature;
    add(b, step, direction_, b);
    add(residual_, -step, product_, residual_);
    energy += step * left;
    precondition();
    const double next = kernels::dot(n, residual_.data(), preconditioned_.data());
    if (next <= accuracy * accuracy * energy) return i;
    add(preconditioned_, next / left, direction_, direction_);
    left = next;
  }
  b.setConstant(std::numeric_limits<double>::quiet_NaN());
  return most;
}

}  // namespace softffd
