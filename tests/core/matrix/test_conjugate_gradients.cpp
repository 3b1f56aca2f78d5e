/// Solutions on wide solved_lattices against those of a factor, on a stiff body out of shape; and what is not positive definite.
#include "bodies.hpp"
#include "check.hpp"
#include "matrix/stiffness_matrix.hpp"

using namespace softffd;

namespace {

const std::vector<Lattice> solved_lattices{{{9, 9, 9}}, {{4, 18, 17}}, {{12, 9, 10}}};

struct Stiff {
  Lattice lattice;
  double omega_g = 1e3;  ///< of the fastest vibration and the step
  Body body = even_body(lattice, 1e4);
  Points x = rest_positions(lattice), b = x;
  Scalars diagonal = 26e4 / (omega_g * omega_g) * (1.2 + Scalars::LinSpaced(lattice.points(), -1, 1));
  LatticeMatrix matrix{lattice};
  DissectedMatrix factor{lattice};

  explicit Stiff(const Lattice& lattice, double omega_g = 1e3) : lattice(lattice), omega_g(omega_g) {
    x.col(0) *= 1.1;
    for (int i = 0; i < x.size(); ++i) x(i) += 0.01 * std::sin(3.0 * i * i), b(i) = std::sin(7.0 * i * i) + 0.5;
  }
  void assemble() {
    softffd::assemble(body, x, {}, diagonal, matrix);
    factor.clear();
    for (int p = 0; p < body.points(); ++p) factor.set_block(p, p, matrix.block(p, p));
    for (const Springs::Row& row : springs_of(body).rows())
      for (int lane = 0; lane < row.lanes(); ++lane) {
        const int p = row.begin + lane, q = p + row.offset;
        if (row.multiplicity[lane] > 0) factor.set_block(p, q, matrix.block(p, q));
      }
    matrix.factor();
    factor.factor();
  }
  double difference() {
    Points one = b, other = b;
    work = matrix.solve(one);
    factor.solve(other);
    return (one - other).abs().maxCoeff() / other.abs().maxCoeff();
  }
  double work = 0;
};

}  // namespace

TEST(solutions_are_those_of_a_factor_and_take_no_longer_on_stiff_bodies) {
  for (const Lattice& lattice : solved_lattices)
    for (const double omega_g : {1.0, 1e2, 1e4, 1e6}) {
      Stiff s(lattice, omega_g);
      s.assemble();
      CHECK(s.difference() < 1e-8 + 1e-16 * omega_g * omega_g);  // the softest feel a hundred times the energy norm's 1e-10; rounding
      CHECK(s.work <= 1.5);
    }
}

TEST(pinned_points_and_crushed_springs_are_solved_for_too) {
  Stiff s(solved_lattices[0]);
  s.x *= 0.5;
  for (int p = 0; p < 81; ++p) s.body.pinned[p] = true;
  s.body.pinned[400] = true;
  s.assemble();
  CHECK(s.difference() < 1e-8);
  CHECK(s.work <= 3);
  Points b = s.b;
  s.matrix.solve(b);
  for (int p = 0; p < 81; ++p)
    for (int a = 0; a < 3; ++a) CHECK_NEAR(b(p, a), s.b(p, a), 1e-8);
}

TEST(a_soft_body_with_a_stiff_layer_is_solved_for_too) {
  Stiff s(solved_lattices[0], 1e2);
  std::vector<bool> bottom(s.body.points(), false);
  std::fill_n(bottom.begin(), 81, true);
  springs_of(s.body).set_stiffness({1e4, 1e4, 1e4}, {{bottom, 1e9}});
  s.assemble();
  CHECK(s.difference() < 1e-6);
  CHECK(s.work <= 5);
}

TEST(nothing_gives_nothing_the_same_the_same_bits_and_less_accuracy_takes_less_work) {
  Stiff s(solved_lattices[0]);
  s.assemble();
  s.difference();
  Points b = s.b;
  CHECK(s.matrix.solve(b, 1e-6) < 0.75 * s.work);
  b.setZero();
  s.matrix.solve(b);
  CHECK((b == 0).all());
  Points one = s.b, other = s.b;
  s.matrix.solve(one);
  s.matrix.solve(b);
  s.matrix.solve(other);
  CHECK((one == other).all());
}

TEST(a_matrix_that_is_not_positive_definite_gives_no_numbers) {
  for (const bool everywhere : {false, true}) {
    Stiff s(solved_lattices[0]);
    s.assemble();
    if (!everywhere)
      s.matrix.set_block(400, 400, -Mat3::Identity());
    else
      for (int p = 0; p < s.body.points(); ++p) s.matrix.add_block(p, p, -s.diagonal.maxCoeff() * Mat3::Identity());
    s.matrix.factor();
    Points b = s.b;
    s.matrix.solve(b);
    CHECK(!b.isFinite().any());
  }
}
