/// What holds of every energy: its forces and its matrix are derivatives, and the matrix is one in all its uses.
#include "bodies.hpp"
#include "check.hpp"
#include "derivatives.hpp"
#include "matrix/stiffness_matrix.hpp"

using namespace softffd;

namespace {

const Lattice lattice{{3, 2, 4}};
constexpr int count = 24;  // of points

Body body_of(bool springs, bool volume, double time = 0, const Lattice& box = lattice) {
  Body body = even_body(box, springs ? 700 : 0);
  springs_of(body).set_dashpots(time);
  if (volume) body.energies.push_back(std::make_shared<Volume>(box, 9e3));
  return body;
}

const std::vector<Linearisation> linearisations{{}, {.softening = 1}, {.softening = 0.25, .per_time = 40}};

Eigen::MatrixXd by_products(const Body& body, const Points& x, const Linearisation& of) {
  return -matrix_of(count, [&](const Points& u, Points& f) { body.subtract_product(x, of, u, f); });
}

/// Of springs alone, spring by spring: those that are compressed have no stiffness across their length.
Eigen::MatrixXd without_softening(const Body& body, const Points& x) {
  Eigen::MatrixXd k = Eigen::MatrixXd::Zero(3 * count, 3 * count);
  for (const Springs::Row& springs : springs_of(body).rows())
    for (int lane = 0; lane < springs.lanes(); ++lane) {
      const int p = springs.begin + lane, q = p + springs.offset;
      const Vec3 d = row(x, q) - row(x, p);
      const double r = d.norm(), e = std::max(0.0, 1 - springs.rest_length[lane] / r);
      const Mat3 along = d * d.transpose() / (r * r), h = springs.stiffness[lane] * (along + e * (Mat3::Identity() - along));
      for (int i = 0; i < 9; ++i)
        for (const int one : {p, q})
          for (const int other : {p, q}) k(one + count * (i / 3), other + count * (i % 3)) += (one == other ? 1 : -1) * h(i / 3, i % 3);
    }
  return k;
}

}  // namespace

TEST(blocks_and_products_are_one_matrix_which_leaves_out_what_is_pinned) {
  const std::array<int, 3> turned[] = {{3, 2, 4}, {4, 3, 2}, {2, 4, 3}, {6, 2, 2}};  // layers lie across the axis with the most points
  for (int trial = 0; trial < 12; ++trial) {
    const Lattice box{turned[trial % 4]};
    Body body = body_of(trial % 3 != 1, trial % 3 != 0, 0.02 * (trial % 2), box);
    const Points x = scattered(box, 0.4, trial);
    if (trial % 4 > 1) body.pinned[3] = body.pinned[8] = true;
    for (const Linearisation& of : linearisations) {
      const Eigen::MatrixXd k = by_products(body, x, of);
      CHECK(largest(k) > 0 && largest(k - k.transpose()) <= 1e-12 * largest(k));
      LatticeMatrix matrix(box);
      assemble(body, x, of, Scalars::Constant(count, 5), matrix);
      const auto near = [n = box.counts](int p, int q) {
        const int layer = n[0] * n[1];
        return std::abs(p % n[0] - q % n[0]) <= 1 && std::abs(p / n[0] % n[1] - q / n[0] % n[1]) <= 1 &&
               std::abs(p / layer - q / layer) <= 1;
      };
      for (int i = 0; i < 3 * count; ++i)
        for (int j = 0; j < 3 * count; ++j) {
          const int p = i % count, q = j % count;
          const bool held = body.pinned[p] || body.pinned[q];
          if (!near(p, q)) continue;
          const double found = matrix.block(p, q)(i / count, j / count), wanted = held ? double(i == j) : k(i, j) + (i == j ? 5 : 0);
          CHECK_NEAR(found, wanted, held ? 0 : 1e-12 * largest(k));
        }
    }
  }
}

TEST(without_softening_it_is_positive_semidefinite) {
  for (int trial = 0; trial < 6; ++trial) {
    const Eigen::MatrixXd k = by_products(body_of(trial % 3 != 1, trial % 3 != 0), scattered(lattice, 0.4, trial), {});
    CHECK(dense::eigenvalues(k).minCoeff() >= -1e-11 * largest(k));
  }
}

TEST(without_softening_compressed_springs_have_no_stiffness_across_and_coinciding_points_none_at_all) {
  Body body = even_body(lattice, 0, 1, Topology::paper);
  springs_of(body).set_stiffness({1000, 700, 300}, {});
  for (const double stretch : {0.8, 1.0, 1.3}) {
    const Points x = crumpled(lattice, 0.1 * (stretch != 1), stretch);
    const Eigen::MatrixXd k = without_softening(body, x);
    CHECK(largest(by_products(body, x, {}) - k) <= 1e-13 * largest(k));
  }
  CHECK(largest(by_products(body, Points::Zero(count, 3), {})) == 0);
}

TEST(with_all_of_it_a_springs_matrix_is_the_second_derivative_and_that_of_its_dashpot_the_derivative_by_velocities) {
  const Body body = body_of(true, false, 0.02);
  const Points x = scattered(lattice, 0.3);
  const Eigen::MatrixXd exact = stiffness_by_differences(x, [&](const Points& at, Points& f) { body.internal_force(at, f); });
  const Eigen::MatrixXd k = by_products(body, x, {.softening = 1});
  CHECK(largest(exact - k) < 1e-6 * largest(k));
  const Eigen::MatrixXd c = -matrix_of(count, [&](const Points& v, Points& f) { body.add_dashpot_force(x, v, f); });
  CHECK(largest(k + 30 * c - by_products(body, x, {.softening = 1, .per_time = 30})) < 1e-12 * largest(30 * c));
  const Points v = scattered(lattice, 1.0, 5);
  const Eigen::Map<const Eigen::VectorXd> along(v.data(), v.size());
  CHECK_NEAR(body.dashpot_power(x, v) / along.dot(c * along), 1.0, 1e-12);
}

TEST(that_of_a_volume_is_the_second_derivative_where_the_force_is_small) {
  Points x = rest_positions(lattice);
  x.col(2) *= 0.4999;  // phi' is the square of 1e-4, phi'' twice that number
  for (int p = 0; p < count; ++p) x(p, 2) += 2e-6 * scattered(p);
  const Body body = body_of(false, true);
  const Eigen::MatrixXd exact = stiffness_by_differences(x, [&](const Points& at, Points& f) { body.internal_force(at, f); });
  const Eigen::MatrixXd k = by_products(body, x, {});
  CHECK(largest(k) > 0 && largest(0.5 * (exact + exact.transpose()) - k) < 1e-3 * largest(k));
}

TEST(forces_are_set_or_added_and_those_of_several_energies_are_a_sum) {
  const Body body = body_of(true, true);
  const Points x = scattered(lattice, 0.4);
  Points both = Points::Constant(count, 3, std::nan("")), sum = Points::Zero(count, 3);
  body.internal_force(x, both);
  for (const auto& each : body.energies) each->add_force(x, sum);
  CHECK(distance(both, sum) == 0);
  const Points slope = gradient(x, [&](const Points& at) { return body.elastic_energy(at); });
  CHECK(distance(both, -slope) < 1e-6 * both.abs().maxCoeff());
  CHECK(!body.fused() && body_of(true, false).fused());
}
