#include "matrix/gmres.hpp"

#include "check.hpp"
#include "dense.hpp"

using namespace softffd;

namespace {

/// A matrix without symmetry, some way from the identity; the same on every machine.
Eigen::MatrixXd matrix(int n, double away) {
  Eigen::MatrixXd a = Eigen::MatrixXd::Identity(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) a(i, j) += away * std::sin(7.0 * i * i + 3.0 * j + i * j);
  return a;
}

Scalars right_side(int n) {
  Scalars b(n);
  for (int i = 0; i < n; ++i) b[i] = std::cos(5.0 * i);
  return b;
}

struct Solved {
  Eigen::VectorXd y;
  int products;
};
Solved solve(Gmres& gmres, const Eigen::MatrixXd& a, const Scalars& b, double reduction) {
  int products = 0;
  const int n = int(b.size());
  const Scalars& y = gmres.solve(n, b, reduction, [&](const Scalars& v, Scalars& av) {
    ++products;
    av.head(n) = (a * v.head(n).matrix()).array();
  });
  return {y.head(n).matrix(), products};
}

double residual(const Eigen::MatrixXd& a, const Scalars& b, const Eigen::VectorXd& y) { return (a * y - b.matrix()).norm(); }

}  // namespace

TEST(as_many_products_as_unknowns_give_the_dense_solution) {
  Gmres gmres(20);
  for (int n = 1; n <= Gmres::most; ++n) {
    const Eigen::MatrixXd a = matrix(n, 0.5);
    const Solved found = solve(gmres, a, right_side(n), 1e-15);
    const Eigen::VectorXd exact = dense::solve(a, right_side(n).matrix());
    CHECK(found.products <= n);
    CHECK_NEAR((found.y - exact).norm(), 0.0, 1e-12 * exact.norm());  // condition numbers below 1e3
  }
}

TEST(it_stops_as_soon_as_the_residual_is_small_enough) {
  Gmres gmres(30);
  const Eigen::MatrixXd a = matrix(30, 0.02);
  const Scalars b = right_side(30);
  int before = 0;
  for (const double reduction : {0.5, 1e-1, 1e-2, 1e-3}) {
    const Solved found = solve(gmres, a, b, reduction);
    CHECK(residual(a, b, found.y) <= reduction * b.matrix().norm() * (1 + 1e-12));
    CHECK(found.products >= before && found.products < Gmres::most);
    before = found.products;
  }
  CHECK(before > 1);
  CHECK(solve(gmres, 3 * Eigen::MatrixXd::Identity(30, 30), b, 1e-12).products == 1);
}

TEST(after_the_last_product_it_gives_the_best_of_the_krylov_space) {
  Gmres gmres(30);
  const Eigen::MatrixXd a = matrix(30, 0.5);
  const Scalars b = right_side(30);
  const Solved found = solve(gmres, a, b, 1e-12);
  CHECK(found.products == Gmres::most);
  Eigen::MatrixXd space(30, Gmres::most);
  Eigen::VectorXd v = b.matrix();
  for (int j = 0; j < Gmres::most; ++j) space.col(j) = v.normalized(), v = a * space.col(j);
  const Eigen::MatrixXd q = dense::orthonormal(space);
  const Eigen::VectorXd best = q * dense::solve(dense::product(a, q), b.matrix());
  CHECK_NEAR(residual(a, b, found.y), residual(a, b, best), 1e-9 * b.matrix().norm());  // the powers of a are nearly dependent
}

TEST(nothing_is_left_of_the_solution_before_and_a_product_that_brings_nothing_ends_it) {
  Gmres used(30), fresh(30);
  const Scalars b = right_side(12);
  solve(used, matrix(30, 0.5), right_side(30), 1e-12);
  CHECK(solve(used, matrix(12, 0.3), b, 1e-3).y == solve(fresh, matrix(12, 0.3), b, 1e-3).y);
  CHECK(solve(used, matrix(12, 0.3), 0 * b, 1e-3).y.isZero(0));
  const Solved found = solve(used, Eigen::MatrixXd::Zero(4, 4), right_side(4), 1e-3);
  CHECK(found.products == 1 && found.y.isZero(0));
}
