#include <random>
#include <set>

#include "check.hpp"
#include "derivatives.hpp"
#include "matrix/layer_matrix.hpp"

using namespace softffd;

namespace {

Lattice solid(std::array<int, 3> counts) { return {.counts = counts, .lobatto = true}; }

const std::vector<Lattice> layered_lattices{{{4, 4, 4}}, {{2, 2, 2}},      {{2, 3, 8}},     {{8, 2, 2}},
                                            {{3, 5, 4}}, solid({4, 4, 4}), solid({4, 7, 4})};

double noise() {
  static std::mt19937 engine(7);
  return double(engine()) / double(engine.max()) - 0.5;  // the same numbers in every standard library
}

int layer(const Lattice& lattice, int axis, int p) {
  const auto& n = lattice.counts;
  const int of[3] = {p % n[0], p / n[0] % n[1], p / (n[0] * n[1])};
  return lattice.lobatto ? of[axis] / 3 : of[axis];
}

/// Dense copy of the lower triangle, both triangles filled; coordinate a of point p is row p + points * a, as in Points.
Eigen::MatrixXd in_full(const Lattice& lattice, LayerMatrix& matrix) {
  const int n = lattice.points();
  Eigen::MatrixXd full = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  for (int p = 0; p < n; ++p)
    for (int q = 0; q < n; ++q)
      if (std::abs(layer(lattice, matrix.axis(), p) - layer(lattice, matrix.axis(), q)) <= 1)
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < 3; ++b) full(p + n * a, q + n * b) = matrix.at(p, a, q, b);
  return full;
}

/// A block-tridiagonal matrix without any zero inside its blocks, positive definite by its diagonal.
void fill(const Lattice& lattice, LayerMatrix& matrix) {
  const int n = lattice.points();
  matrix.clear();
  for (int p = 0; p < n; ++p)
    for (int q = 0; q <= p; ++q)
      if (std::abs(layer(lattice, matrix.axis(), p) - layer(lattice, matrix.axis(), q)) <= 1)
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < 3; ++b) matrix.at(p, a, q, b) = p == q && a == b ? 0.6 * n + noise() : noise();
}

}  // namespace

TEST(layers_lie_across_the_axis_with_the_most_points_and_every_coordinate_is_one_unknown) {
  const int axes[] = {2, 2, 2, 0, 1, 2, 1}, layers[] = {4, 2, 8, 8, 5, 2, 3};
  for (std::size_t i = 0; i < layered_lattices.size(); ++i) {
    const LayerMatrix matrix(layered_lattices[i]);
    CHECK(matrix.axis() == axes[i] && matrix.layers() == layers[i]);
    std::set<int> seen;
    for (int u = 0; u < 3 * layered_lattices[i].points(); ++u) seen.insert(matrix.unknown(u / 3, u % 3));
    CHECK(int(seen.size()) == 3 * layered_lattices[i].points());
  }
}

TEST(solutions_are_those_of_a_dense_factor) {
  for (const Lattice& lattice : layered_lattices) {
    LayerMatrix matrix(lattice);
    for (int repeat = 0; repeat < 3; ++repeat) {
      fill(lattice, matrix);
      const Eigen::MatrixXd full = in_full(lattice, matrix);
      CHECK(full == full.transpose());
      Points b(lattice.points(), 3);
      for (int i = 0; i < b.size(); ++i) b.data()[i] = noise();
      const Eigen::VectorXd right = Eigen::Map<Eigen::VectorXd>(b.data(), b.size()), expected = dense::solve(full, right);
      matrix.factor();
      matrix.solve(b);
      const Eigen::VectorXd found = Eigen::Map<Eigen::VectorXd>(b.data(), b.size());
      CHECK_NEAR(largest(found - expected), 0.0, 1e-13 * largest(expected));  // condition about 10
      CHECK_NEAR(largest(full * found - right), 0.0, 1e-14 * lattice.points());
    }
  }
}

TEST(right_sides_that_are_solved_for_together_have_the_same_solutions_whichever_they_are) {
  for (const Lattice& lattice : layered_lattices) {
    LayerMatrix matrix(lattice);
    fill(lattice, matrix);
    matrix.factor();
    std::vector<Points> sides(LayerMatrix::together, Points(lattice.points(), 3));
    std::vector<Points*> all;
    for (Points& side : sides) {
      for (int i = 0; i < side.size(); ++i) side.data()[i] = noise();
      all.push_back(&side);
    }
    std::vector<Points> alone = sides, first = sides;
    matrix.solve_together(all);
    for (std::size_t s = 0; s < sides.size(); ++s) {
      Points* one = &first[s];
      matrix.solve_together({&one, 1});
      CHECK((first[s] == sides[s]).all());
      matrix.solve(alone[s]);
      CHECK_NEAR((alone[s] - sides[s]).abs().maxCoeff(), 0.0, 1e-15 * lattice.points() * alone[s].abs().maxCoeff());
    }
  }
}

TEST(a_matrix_that_is_not_positive_definite_gives_no_numbers) {
  const Lattice lattice;
  LayerMatrix matrix(lattice);
  fill(lattice, matrix);
  matrix.at(9, 1, 9, 1) = -1;
  matrix.factor();
  Points b = Points::Ones(lattice.points(), 3);
  matrix.solve(b);
  CHECK(!b.isFinite().all());
}
