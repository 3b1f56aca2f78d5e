#include "check.hpp"
#include "matrix/coarse_lattice.hpp"

using namespace softffd;

namespace {

const std::vector<Lattice> lattices{{{9, 9, 9}}, {{16, 16, 16}}, {{12, 8, 10}}, {{32, 32, 4}}, {{2, 9, 33}}, {{32, 32, 32}}};

/// Springs of different strength between all neighbours, and a little mass.
void fill(const Lattice& lattice, StencilMatrix& matrix) {
  const auto& n = lattice.counts;
  matrix.clear();
  for (int p = 0; p < lattice.points(); ++p) {
    matrix.add_block(p, p, 0.01 * Mat3::Identity());
    for (const Direction& d : directions) {
      const int i = p % n[0], j = p / n[0] % n[1], k = p / (n[0] * n[1]);
      if (!d.within(lattice, i, j, k)) continue;
      const int q = lattice.index(i + d.di, j + d.dj, k + d.dk);
      const Eigen::Vector3d u = Eigen::Vector3d(d.di, d.dj, d.dk).normalized();
      const Mat3 block = (1 + 0.5 * std::sin(p)) * u * u.transpose();
      matrix.add_block(p, p, block);
      matrix.add_block(q, q, block);
      matrix.set_block(p, q, -block);
    }
  }
}

}  // namespace

TEST(its_layers_are_narrow_and_its_spacing_is_at_least_three) {
  const std::array<int, 3> counts[] = {{4, 4, 4}, {6, 6, 6}, {5, 4, 4}, {12, 12, 2}, {2, 4, 12}, {8, 8, 8}};
  for (std::size_t i = 0; i < lattices.size(); ++i) CHECK(CoarseLattice(lattices[i]).lattice().counts == counts[i]);
}

/// P^T A P c = P^T r for r = A P c: what is linear between all nodes is found exactly.
TEST(rigid_and_even_motions_are_corrected_exactly) {
  for (const Lattice& lattice : lattices) {
    if (lattice.points() > 5000) continue;
    const int n = lattice.points();
    StencilMatrix matrix(lattice);
    fill(lattice, matrix);
    CoarseLattice coarse(lattice);
    coarse.factor(matrix);
    const Points x = rest_positions(lattice);
    Points u(n, 3), r(n, 3), z = Points::Zero(n, 3);
    for (int p = 0; p < n; ++p) set_row(u, p, Vec3(1, -2, 3) + Vec3(0.3, 0.1, -0.7).cross(row(x, p)) + 0.5 * x(p, 1) * Vec3(0, 1, 2));
    matrix.multiply(u, r);
    coarse.add_correction(r, z);
    CHECK_NEAR((z - u).abs().maxCoeff(), 0.0, 1e-10);  // condition 1e5
    coarse.add_correction(r, z);
    CHECK_NEAR((z - 2 * u).abs().maxCoeff(), 0.0, 2e-10);
  }
}
