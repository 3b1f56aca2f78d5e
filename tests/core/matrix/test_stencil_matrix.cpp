#include "check.hpp"
#include "matrix/stencil_matrix.hpp"

using namespace softffd;

namespace {

double pseudo_random(int i) { return std::sin(12.9898 * i * i + 78.233 * i); }

const std::vector<Lattice> stencil_lattices{{{4, 4, 4}}, {{2, 2, 2}}, {{2, 9, 3}}, {{9, 2, 4}}, {{7, 6, 8}}};

Mat3 noise(int seed, bool symmetric) {
  Mat3 block;
  for (int i = 0; i < 9; ++i) block.data()[i] = pseudo_random(9 * seed + i);
  return symmetric ? Mat3(block + block.transpose()) : block;
}

template <class Visit>
void visit_pairs(const Lattice& lattice, Visit visit) {
  const auto& n = lattice.counts;
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i)
        for (const Direction& d : directions)
          if (d.within(lattice, i, j, k)) visit(lattice.index(i, j, k), lattice.index(i + d.di, j + d.dj, k + d.dk));
}

/// Blocks of noise, in the matrix and in a dense one.
Eigen::MatrixXd filled(const Lattice& lattice, StencilMatrix& matrix) {
  const int n = lattice.points();
  Eigen::MatrixXd full = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  const auto put = [&](int p, int q, const Mat3& block) {
    matrix.set_block(p, q, block);
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) full(p + n * a, q + n * b) = full(q + n * b, p + n * a) = block(a, b);
  };
  matrix.clear();
  for (int p = 0; p < n; ++p) put(p, p, noise(p, true));
  visit_pairs(lattice, [&](int p, int q) { put(p, q, noise(n + 40 * p + q, false)); });
  return full;
}

}  // namespace

TEST(the_product_is_that_of_the_dense_matrix) {
  for (const Lattice& lattice : stencil_lattices) {
    StencilMatrix matrix(lattice);
    const Eigen::MatrixXd full = filled(lattice, matrix);
    Points x(lattice.points(), 3), y(lattice.points(), 3);
    for (int i = 0; i < x.size(); ++i) x.data()[i] = pseudo_random(i);
    matrix.multiply(x, y);
    const Eigen::VectorXd expected = full * Eigen::Map<Eigen::VectorXd>(x.data(), x.size());
    CHECK_NEAR((Eigen::Map<Eigen::VectorXd>(y.data(), y.size()) - expected).cwiseAbs().maxCoeff(), 0.0, 1e-14 * 81);
  }
}

TEST(a_block_is_the_transpose_of_its_mirror_image_and_every_pair_of_neighbours_is_visited_once) {
  for (const Lattice& lattice : stencil_lattices) {
    StencilMatrix matrix(lattice);
    filled(lattice, matrix);
    int pairs = 0;
    visit_pairs(lattice, [&](int p, int q) { CHECK(++pairs && matrix.block(p, q) == matrix.block(q, p).transpose()); });
    matrix.visit_couplings([&](int p, int q, const Mat3& block) { CHECK(pairs-- && p < q && block == matrix.block(p, q)); });
    CHECK(pairs == 0);
    const int q = lattice.index(1, 1, 1);
    const Mat3 before = matrix.block(0, q), more = noise(3, false);
    matrix.add_block(q, 0, more);
    CHECK(matrix.block(0, q) == before + more.transpose());
    matrix.set_block(q, 0, more);
    CHECK(matrix.block(0, q) == more.transpose());
  }
}
