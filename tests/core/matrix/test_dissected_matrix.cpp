#include <algorithm>
#include <random>

#include "check.hpp"
#include "derivatives.hpp"
#include "matrix/dissected_matrix.hpp"

using namespace softffd;

namespace {

Lattice solid(std::array<int, 3> counts) { return {.counts = counts, .lobatto = true}; }

const std::vector<Lattice> dissected_lattices{{{4, 4, 4}}, {{2, 2, 2}},      {{2, 3, 8}},      {{9, 2, 2}},      {{3, 5, 4}},
                                              {{6, 5, 7}}, solid({4, 4, 4}), solid({4, 7, 4}), solid({7, 7, 7}), solid({4, 10, 7})};

double noise() {
  static std::mt19937 engine(7);
  return double(engine()) / double(engine.max()) - 0.5;  // the same numbers in every standard library
}

/// What every point is coupled with, itself among them.
std::vector<std::vector<int>> coupled_with(const Lattice& lattice) {
  auto coupled = coupled_points(lattice);
  for (int p = 0; p < lattice.points(); ++p) coupled[p].push_back(p);
  return coupled;
}

/// Dense copy; coordinate a of point p is row p + points * a, as in Points.
Eigen::MatrixXd in_full(const Lattice& lattice, const DissectedMatrix& matrix) {
  const int n = lattice.points();
  const auto coupled = coupled_with(lattice);
  Eigen::MatrixXd full = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  for (int p = 0; p < n; ++p)
    for (const int q : coupled[p]) {
      const Mat3 block = matrix.block(p, q);
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) full(p + n * a, q + n * b) = block(a, b);
    }
  return full;
}

/// A matrix that couples all that an element couples, positive definite by its diagonal.
void fill(const Lattice& lattice, DissectedMatrix& matrix) {
  const auto coupled = coupled_with(lattice);
  matrix.clear();
  for (int p = 0; p < lattice.points(); ++p)
    for (const int q : coupled[p]) {
      if (q > p) continue;
      Mat3 block = Mat3::NullaryExpr([](auto, auto) { return noise(); });
      if (q == p) block = Mat3(0.5 * (block + block.transpose()) + coupled[p].size() * Mat3::Identity());
      matrix.set_block(p, q, block);
    }
}

}  // namespace

TEST(every_point_leaves_once_and_what_it_then_meets_leaves_later) {
  for (const Lattice& lattice : dissected_lattices) {
    const Dissection order(lattice);
    const auto coupled = coupled_with(lattice);
    std::vector<int> left(lattice.points(), 0);
    for (int f = 0; f < int(order.fronts().size()); ++f) {
      const auto& front = order.fronts()[f];
      for (int row = 0; row < front.own; ++row) {
        const int p = front.points[row];
        ++left[p];
        CHECK(order.front(p) == f && order.row(p) == row);
        for (const int q : coupled[p])
          if (order.front(q) > f) CHECK(front.points[order.row(front, q)] == q);
      }
      for (int row = front.own; row < int(front.points.size()); ++row) CHECK(order.front(front.points[row]) > f);
      CHECK((front.parent < 0) == (front.boundary() == 0) && (front.parent < 0 || front.parent > f));
    }
    CHECK(std::ranges::all_of(left, [](int times) { return times == 1; }));
  }
}

TEST(a_wide_solid_is_cut_between_its_patches_and_costs_little) {
  const Dissection order(solid({13, 13, 13}));
  CHECK(order.fronts().size() == 127);  // 64 patches and 63 planes between them
  for (const auto& front : order.fronts()) CHECK(front.own <= 169);
  const double unknowns = 3 * 13 * 13 * 13, band = 3 * 4 * 169;
  CHECK(order.factor_work() < 0.03 * unknowns * band * band / 2);
}

TEST(solutions_are_those_of_a_dense_factor) {
  for (const Lattice& lattice : dissected_lattices) {
    DissectedMatrix matrix(lattice);
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
  for (const Lattice& lattice : dissected_lattices) {
    DissectedMatrix matrix(lattice);
    fill(lattice, matrix);
    matrix.factor();
    std::vector<Points> sides(DissectedMatrix::together, Points(lattice.points(), 3));
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
  DissectedMatrix matrix(lattice);
  fill(lattice, matrix);
  Mat3 block = matrix.block(9, 9);
  block(1, 1) = -1;
  matrix.set_block(9, 9, block);
  matrix.factor();
  Points b = Points::Ones(lattice.points(), 3);
  matrix.solve(b);
  CHECK(!b.isFinite().all());
}
