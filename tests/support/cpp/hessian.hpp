/// Second derivatives of a body's energy by differences of its forces, for comparison: rows and columns of pinned points are zero.
#pragma once
#include "dense.hpp"
#include "forces/body.hpp"

namespace softffd {

inline Eigen::MatrixXd hessian(const Body& body, const Points& x) {
  const int n = body.points();
  Eigen::MatrixXd h = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  Points y = x, above(n, 3), below(n, 3);
  const double d = 1e-6;
  for (int c = 0; c < 3 * n; ++c) {
    if (body.pinned[c % n]) continue;
    y.data()[c] = x.data()[c] + d;
    body.internal_force(y, above);
    y.data()[c] = x.data()[c] - d;
    body.internal_force(y, below);
    y.data()[c] = x.data()[c];
    for (int r = 0; r < 3 * n; ++r)
      if (!body.pinned[r % n]) h(r, c) = (below.data()[r] - above.data()[r]) / (2 * d);
  }
  return 0.5 * (h + h.transpose());
}

/// The highest frequency of the body at x [rad/s], 0 where nothing pulls it back; by a dense eigenvalue solver.
inline double highest_frequency(const Body& body, const Points& x) {
  Eigen::VectorXd root(3 * body.points());
  for (int i = 0; i < root.size(); ++i) root[i] = std::sqrt(body.mass[i % body.points()]);
  const Eigen::MatrixXd scaled = root.cwiseInverse().asDiagonal() * hessian(body, x) * root.cwiseInverse().asDiagonal();
  return std::sqrt(std::max(0.0, dense::eigenvalues(scaled).maxCoeff()));
}

}  // namespace softffd
