#include "matrix/volume_hessian.hpp"

#include "check.hpp"
#include "dense.hpp"

using namespace softffd;

namespace {

constexpr double kappa = 9e3;

double scattered(int i) { return 0.5 + 0.5 * std::sin(12.9898 * i * i + 78.233 * i); }

Points crumpled(const Lattice& lattice, double amplitude, int seed) {
  Points x = rest_positions(lattice);
  for (int i = 0; i < x.size(); ++i) x.data()[i] += 2 * amplitude * (scattered(100 * seed + i) - 0.5);
  return x;
}

/// -K by products with unit vectors.
Eigen::MatrixXd products(const Volume& volume, const Points& x) {
  const int n = int(x.rows());
  Eigen::MatrixXd k(3 * n, 3 * n);
  for (int c = 0; c < 3 * n; ++c) {
    Points u = Points::Zero(n, 3), f = Points::Zero(n, 3);
    u.data()[c] = 1;
    subtract_stiffness_product(volume, x, u, f);
    k.col(c) = Eigen::Map<Eigen::VectorXd>(f.data(), 3 * n);
  }
  return k;
}

/// Second derivatives of the energy, by differences of the forces.
Eigen::MatrixXd hessian(const Volume& volume, const Points& x) {
  const int n = int(x.rows());
  const double d = 1e-6;
  Eigen::MatrixXd h(3 * n, 3 * n);
  Points y = x;
  for (int c = 0; c < 3 * n; ++c) {
    Points above = Points::Zero(n, 3), below = Points::Zero(n, 3);
    y.data()[c] = x.data()[c] + d;
    volume.add_force(y, above);
    y.data()[c] = x.data()[c] - d;
    volume.add_force(y, below);
    y.data()[c] = x.data()[c];
    for (int r = 0; r < 3 * n; ++r) h(r, c) = (below.data()[r] - above.data()[r]) / (2 * d);
  }
  return 0.5 * (h + h.transpose());
}

}  // namespace

TEST(stiffness_is_positive_semidefinite_and_one_matrix_in_all_its_uses) {
  const Lattice lattice{{3, 2, 4}};
  const Volume volume(lattice, kappa);
  for (int trial = 0; trial < 4; ++trial) {
    const Points x = crumpled(lattice, 0.4, trial);
    const Eigen::MatrixXd k = -products(volume, x);
    CHECK((k - k.transpose()).cwiseAbs().maxCoeff() <= 1e-12 * k.cwiseAbs().maxCoeff());
    CHECK(dense::eigenvalues(k).minCoeff() >= -1e-11 * k.cwiseAbs().maxCoeff());
    std::vector<bool> pinned(24, false);
    if (trial % 2) pinned[3] = pinned[8] = true;
    LatticeMatrix matrix(lattice);
    matrix.clear();
    add_stiffness(volume, x, pinned, matrix);
    for (int p = 0; p < 24; ++p)
      for (int q = 0; q < 24; ++q)
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < 3; ++b) {
            const auto place = [&](int point) { return std::array{point % 3, point / 3 % 2, point / 6}; };
            bool near = true;
            for (int axis = 0; axis < 3; ++axis) near = near && std::abs(place(p)[axis] - place(q)[axis]) <= 1;
            const double wanted = pinned[p] || pinned[q] ? 0 : k(a * 24 + p, b * 24 + q);
            if (near) CHECK_NEAR(matrix.block(p, q)(a, b), wanted, 1e-12 * k.cwiseAbs().maxCoeff());
          }
  }
}

TEST(stiffness_is_the_second_derivative_where_the_force_is_small) {
  const Lattice lattice;
  const Volume volume(lattice, kappa);
  Points x = rest_positions(lattice);
  x.col(2) *= 0.4999;  // phi' is the square of 1e-4, phi'' twice that number
  for (int p = 0; p < 64; ++p) x(p, 2) += 2e-6 * scattered(p);
  const Eigen::MatrixXd exact = hessian(volume, x), k = -products(volume, x);
  CHECK((exact - k).cwiseAbs().maxCoeff() < 1e-3 * k.cwiseAbs().maxCoeff());
}
