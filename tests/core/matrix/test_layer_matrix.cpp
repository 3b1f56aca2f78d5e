#include <random>
#include <set>

#include "bodies.hpp"
#include "check.hpp"
#include "derivatives.hpp"
#include "matrix/layer_matrix.hpp"
#include "matrix/stiffness_matrix.hpp"

using namespace softffd;

namespace {

const std::vector<Lattice> layered_lattices{{{4, 4, 4}}, {{2, 2, 2}}, {{2, 3, 8}}, {{8, 2, 2}}, {{3, 5, 4}}};

double noise() {
  static std::mt19937 engine(7);
  return double(engine()) / double(engine.max()) - 0.5;  // the same numbers in every standard library
}

int layer(const Lattice& lattice, int axis, int p) {
  const auto& n = lattice.counts;
  const int of[3] = {p % n[0], p / n[0] % n[1], p / (n[0] * n[1])};
  return of[axis];
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

struct Sample {
  Lattice lattice;
  Body body;
  Points x;
};

Sample sample(const Lattice& lattice, double stretch, double amplitude) {
  Sample s{lattice, even_body(lattice, 0, 1, Topology::paper), crumpled(lattice, amplitude, stretch)};
  springs_of(s.body).set_stiffness({1000, 700, 300}, {});
  return s;
}

Eigen::MatrixXd stiffness(const Sample& s, double diagonal = 0) {
  const int n = s.body.points();
  LatticeMatrix matrix(s.lattice);
  assemble(s.body, s.x, {}, Scalars::Constant(n, diagonal), matrix);
  Eigen::MatrixXd full = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  const auto copy = [&](int p, int q) {
    const Mat3 block = matrix.block(p, q);
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) full(p + n * a, q + n * b) = full(q + n * b, p + n * a) = block(a, b);
  };
  for (int p = 0; p < n; ++p) copy(p, p);
  for (const Springs::Row& row : springs_of(s.body).rows())
    for (int lane = 0; lane < row.lanes(); ++lane)
      if (row.multiplicity[lane] > 0) copy(row.begin + lane, row.begin + lane + row.offset);
  return full;
}

/// The formula of the header, spring by spring.
Eigen::MatrixXd projected(const Sample& s) {
  const int n = s.body.points();
  Eigen::MatrixXd full = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  for (const Springs::Row& spring_row : springs_of(s.body).rows())
    for (int lane = 0; lane < spring_row.lanes(); ++lane) {
      const int p = spring_row.begin + lane, q = p + spring_row.offset;
      const Vec3 d = row(s.x, q) - row(s.x, p);
      const double r = d.norm(), e = std::max(0.0, 1 - spring_row.rest_length[lane] / r);
      const Eigen::Matrix3d uu = d * d.transpose() / (r * r);
      const Eigen::Matrix3d h = spring_row.stiffness[lane] * (uu + e * (Eigen::Matrix3d::Identity() - uu));
      for (int i = 0; i < 9; ++i)
        for (const int one : {p, q})
          for (const int other : {p, q}) full(one + n * (i / 3), other + n * (i % 3)) += (one == other ? 1 : -1) * h(i / 3, i % 3);
    }
  return full;
}

/// -dF/dx by central differences.
Eigen::MatrixXd differences(const Sample& s) {
  return stiffness_by_differences(s.x, [&](const Points& x, Points& f) { s.body.internal_force(x, f); });
}

}  // namespace

TEST(layers_lie_across_the_axis_with_the_most_points_and_every_coordinate_is_one_unknown) {
  const int axes[] = {2, 2, 2, 0, 1}, layers[] = {4, 2, 8, 8, 5};
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

TEST(at_rest_and_stretched_the_stiffness_is_minus_the_derivative_of_the_forces) {
  for (const Lattice& lattice : layered_lattices)
    for (double stretch : {1.0, 1.3}) {
      const Sample s = sample(lattice, stretch, stretch > 1 ? 0.01 : 0.0);
      CHECK_NEAR(largest(stiffness(s) - differences(s)), 0.0, 1e-4);  // differences of forces of some 1000 N over 2e-6 m
    }
}

TEST(compressed_springs_have_no_transverse_stiffness) {
  for (const Lattice& lattice : layered_lattices) {
    const Sample s = sample(lattice, 0.8, 0.1);
    const Eigen::MatrixXd k = stiffness(s), formula = projected(s);
    CHECK_NEAR(largest(k - formula), 0.0, 1e-13 * largest(formula));
    CHECK(largest(k - differences(s)) > 1e-3 * largest(k));
    CHECK(k == k.transpose());
    const Eigen::VectorXd eigenvalues = dense::eigenvalues(k);
    CHECK(eigenvalues.minCoeff() > -1e-13 * eigenvalues.maxCoeff());
  }
}

TEST(the_diagonal_is_added_once_and_coinciding_points_have_no_stiffness) {
  Sample s = sample({}, 1.1, 0.02);
  const Eigen::MatrixXd difference = stiffness(s, 2048) - stiffness(s);
  CHECK_NEAR(largest(difference - 2048 * Eigen::MatrixXd::Identity(192, 192)), 0.0, 1e-11);
  s.x.setZero();
  CHECK(largest(stiffness(s)) == 0);
}

TEST(pinned_points_keep_their_values_and_do_not_reach_the_others) {
  Sample s = sample({}, 1.1, 0.02);
  const Eigen::MatrixXd free = stiffness(s, 50);
  for (int p : {0, 21, 40}) s.body.pinned[p] = true;
  const Eigen::MatrixXd k = stiffness(s, 50);
  for (int i = 0; i < 192; ++i)
    for (int j = 0; j < 192; ++j) CHECK(k(i, j) == (s.body.pinned[i % 64] || s.body.pinned[j % 64] ? double(i == j) : free(i, j)));
}
