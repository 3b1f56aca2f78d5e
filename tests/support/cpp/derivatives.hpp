/// Derivatives by central differences and matrices by products, for comparison.
#pragma once
#include "body/body.hpp"
#include "dense.hpp"

namespace softffd {

/// The derivative of a number [m] of all coordinates.
template <class Number>
Points gradient(Points x, Number&& number, double d = 1e-6) {
  Points slope(x.rows(), 3);
  for (int i = 0; i < x.size(); ++i) {
    const double here = x(i);
    x(i) = here + d;
    const double above = number(x);
    x(i) = here - d;
    slope(i) = (above - number(x)) / (2 * d);
    x(i) = here;
  }
  return slope;
}

/// The derivative of forces that `add(x, f)` adds, with the sign of a stiffness.
template <class Add>
Eigen::MatrixXd stiffness_by_differences(Points x, Add&& add, double d = 1e-6) {
  Eigen::MatrixXd k(x.size(), x.size());
  for (int c = 0; c < x.size(); ++c) {
    Points above = Points::Zero(x.rows(), 3), below = above;
    const double here = x(c);
    x(c) = here + d;
    add(x, above);
    x(c) = here - d;
    add(x, below);
    x(c) = here;
    for (int r = 0; r < x.size(); ++r) k(r, c) = (below(r) - above(r)) / (2 * d);
  }
  return k;
}

/// The matrix whose products with u `add(u, f)` adds to f.
template <class Add>
Eigen::MatrixXd matrix_of(int points, Add&& add) {
  Eigen::MatrixXd matrix(3 * points, 3 * points);
  for (int c = 0; c < 3 * points; ++c) {
    Points u = Points::Zero(points, 3), f = u;
    u(c) = 1;
    add(u, f);
    matrix.col(c) = Eigen::Map<const Eigen::VectorXd>(f.data(), f.size());
  }
  return matrix;
}

inline double largest(const Eigen::MatrixXd& matrix) { return matrix.cwiseAbs().maxCoeff(); }

/// The highest frequency of the body at x [rad/s], 0 where nothing pulls it back; by a dense eigenvalue solver.
inline double highest_frequency(const Body& body, const Points& x) {
  const int n = body.points();
  Eigen::MatrixXd h = stiffness_by_differences(x, [&](const Points& at, Points& f) { body.internal_force(at, f); });
  Eigen::VectorXd root(3 * n);
  for (int i = 0; i < 3 * n; ++i) {
    root[i] = std::sqrt(body.mass[i % n]);
    if (body.pinned[i % n]) h.row(i).setZero(), h.col(i).setZero();
  }
  const Eigen::MatrixXd scaled = root.cwiseInverse().asDiagonal() * (0.5 * (h + h.transpose())) * root.cwiseInverse().asDiagonal();
  return std::sqrt(std::max(0.0, dense::eigenvalues(scaled).maxCoeff()));
}

/// The largest eigenvalue of M^-1 A, where `subtract(u, f)` takes A u from f: Lanczos's method, with every vector orthogonal to all before.
template <class Subtract>
double largest_eigenvalue(const Body& body, Subtract&& subtract) {
  const int n = 3 * body.points(), steps = 120;
  const Eigen::ArrayXd root = body.mass.sqrt().replicate(3, 1);
  Eigen::MatrixXd basis(n, steps), small = Eigen::MatrixXd::Zero(steps, steps);
  Eigen::VectorXd next = Eigen::VectorXd::NullaryExpr(n, [](Eigen::Index i) { return std::sin(1.0 + i * i); });
  for (int k = 0; k < steps; ++k) {
    basis.col(k) = next.normalized();
    Points u(body.points(), 3), f = Points::Zero(body.points(), 3);
    Eigen::Map<Eigen::ArrayXd>(u.data(), n) = basis.col(k).array() / root;
    subtract(u, f);
    next = -Eigen::Map<Eigen::ArrayXd>(f.data(), n) / root;
    const auto before = basis.leftCols(k + 1);
    small.col(k).head(k + 1) = before.transpose() * next;
    small.row(k) = small.col(k).transpose();
    for (int twice = 0; twice < 2; ++twice) next -= before * (before.transpose() * next).eval();
  }
  return dense::eigenvalues(small).maxCoeff();
}

}  // namespace softffd
