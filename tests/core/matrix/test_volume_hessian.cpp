#include "matrix/volume_hessian.hpp"

#include "bodies.hpp"
#include "check.hpp"
#include "derivatives.hpp"

using namespace softffd;

namespace {

constexpr double modulus = 9e3;

Eigen::MatrixXd by_products(const Volume& volume, const Points& x) {
  return -matrix_of(int(x.rows()), [&](const Points& u, Points& f) { subtract_stiffness_product(volume, x, u, f); });
}

}  // namespace

TEST(stiffness_is_positive_semidefinite_and_one_matrix_in_all_its_uses) {
  const Lattice lattice{{3, 2, 4}};
  const Volume volume(lattice, modulus);
  for (int trial = 0; trial < 4; ++trial) {
    const Points x = scattered(lattice, 0.4, trial);
    const Eigen::MatrixXd k = by_products(volume, x);
    CHECK(largest(k - k.transpose()) <= 1e-12 * largest(k));
    CHECK(dense::eigenvalues(k).minCoeff() >= -1e-11 * largest(k));
    std::vector<bool> pinned(24, false);
    if (trial % 2) pinned[3] = pinned[8] = true;
    LatticeMatrix matrix(lattice);
    matrix.clear();
    add_stiffness(volume, x, pinned, matrix);
    const auto near = [](int p, int q) {
      return std::abs(p % 3 - q % 3) <= 1 && std::abs(p / 3 % 2 - q / 3 % 2) <= 1 && std::abs(p / 6 - q / 6) <= 1;
    };
    for (int i = 0; i < 72; ++i)
      for (int j = 0; j < 72; ++j) {
        const int p = i % 24, q = j % 24;
        const double wanted = pinned[p] || pinned[q] ? 0 : k(i, j);
        if (near(p, q)) CHECK_NEAR(matrix.block(p, q)(i / 24, j / 24), wanted, 1e-12 * largest(k));
      }
  }
}

TEST(stiffness_is_the_second_derivative_where_the_force_is_small) {
  const Volume volume(Lattice{}, modulus);
  Points x = rest_positions({});
  x.col(2) *= 0.4999;  // phi' is the square of 1e-4, phi'' twice that number
  for (int p = 0; p < 64; ++p) x(p, 2) += 2e-6 * scattered(p);
  const Eigen::MatrixXd exact = stiffness_by_differences(x, [&](const Points& at, Points& f) { volume.add_force(at, f); });
  const Eigen::MatrixXd k = by_products(volume, x);
  CHECK(largest(0.5 * (exact + exact.transpose()) - k) < 1e-3 * largest(k));
}
