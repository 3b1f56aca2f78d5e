#include "matrix/partial_factor.hpp"

#include <Eigen/Cholesky>

#include "check.hpp"
#include "random_numbers.hpp"

using namespace softffd;

/// Solves with the factor for the first unknowns, and densely for the others, whose Schur complement it leaves.
TEST(first_unknowns_are_eliminated_and_the_others_left) {
  Random random;
  for (const int first : {0, 1, 8, 13})
    for (const int others : {0, 2, 8, 11}) {
      const int n = first + others;
      if (n == 0) continue;
      Eigen::MatrixXd half(n, n), a;
      Eigen::VectorXd b(n), x(n);
      for (int i = 0; i < half.size(); ++i) half(i) = random(-1, 1);
      for (int i = 0; i < n; ++i) b[i] = random(-1, 1);
      a = half * half.transpose() + Eigen::MatrixXd::Identity(n, n);
      PartialFactor factor;
      factor.resize(first, others);
      for (int j = 0; j < n; ++j)
        for (int i = j; i < n; ++i) factor(i, j) = a(i, j);
      for (int i = 0; i < n; ++i) factor.right(i) = b[i];
      factor.factor();
      factor.eliminate();
      Eigen::MatrixXd left(others, others);
      Eigen::VectorXd right(others);
      for (int j = 0; j < others; ++j) {
        right[j] = factor.right(first + j);
        for (int i = j; i < others; ++i) left(i, j) = left(j, i) = factor(first + i, first + j);
      }
      if (others > 0) right = left.llt().solve(right).eval();
      for (int i = 0; i < others; ++i) factor.right(first + i) = right[i];
      factor.substitute();
      for (int i = 0; i < n; ++i) x[i] = factor.right(i);
      CHECK((a * x - b).norm() < 1e-12 * b.norm());
    }
}
