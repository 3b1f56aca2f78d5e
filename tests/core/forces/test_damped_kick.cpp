#include "body/damped_kick.hpp"

#include <Eigen/Geometry>

#include "derivatives.hpp"
#include "ros34pw2_scenes.hpp"

using namespace softffd;

namespace {

/// A crumpled body with dashpots of so many seconds.
struct Crumpled {
  explicit Crumpled(double time, bool damped = false) : scene(with_dashpots(soft(damped, false, lattice), time)), x(crumpled(lattice)) {}
  Lattice lattice{{3, 4, 2}};
  Scene scene;
  Points x;
  const Body& body() const { return scene.body; }
  Points none() const { return Points::Zero(x.rows(), 3); }

  Points kicked(double t, const Points& force, const Points& v0) const {
    DampedKick kick(body().points());
    kick.prepare(body(), t, body().fastest_damping);
    Points v = none();
    Points inner = force;
    body().add_dashpot_force(x, v0, inner);
    kick.apply(body(), x, inner, none(), v0, v);
    return v;
  }
};

double kinetic(const Body& body, const Points& v) { return 0.5 * (body.mass * v.square().rowwise().sum()).sum(); }

}  // namespace

TEST(it_is_of_second_order_and_converges_to_the_exact_flow) {
  const Crumpled c(0.01, true);
  const Points force = c.scene.around.force, v0 = c.scene.start.v;
  const auto after = [&](int kicks) {
    Points v = v0;
    for (int i = 0; i < kicks; ++i) v = c.kicked(0.05 / kicks, force, v);
    return v;
  };
  const Points exact = after(4096);
  const double a = distance(after(64), exact), b = distance(after(128), exact);
  CHECK_NEAR(std::log2(a / b), 2.0, 0.15);
}

TEST(a_balance_of_forces_and_damping_stays) {
  const Crumpled c(0.05, true);
  const Points v0 = c.scene.start.v;
  Points force = c.none();
  c.body().add_dashpot_force(c.x, v0, force);
  force = -force;
  for (int axis = 0; axis < 3; ++axis) force.col(axis) += c.body().damping * v0.col(axis);
  CHECK_NEAR(distance(c.kicked(0.3, force, v0), v0), 0.0, 1e-12);  // rounding of forces of 100 N on 0.1 kg, in some 50 products
}

TEST(it_is_stable_for_any_damping_and_takes_energy) {
  for (const double time : {1e-4, 1e-2, 1.0, 100.0}) {
    const Crumpled c(time);
    const double before = kinetic(c.body(), c.scene.start.v), after = kinetic(c.body(), c.kicked(0.02, c.none(), c.scene.start.v));
    CHECK(after < before);
  }
}

TEST(strong_damping_costs_little_more_than_its_square_root) {
  const auto products = [](double time) {
    const Crumpled c(time);
    DampedKick kick(c.body().points());
    kick.prepare(c.body(), 0.02, c.body().fastest_damping);
    return kick.products();
  };
  CHECK(products(1e-6) == 2);
  CHECK_NEAR(products(100.0) / double(products(1.0)), 14.5, 0.1);
}

TEST(of_a_motion_it_leaves_the_exponential_or_at_most_the_inverse_of_the_kicks_rate) {
  for (const double time : {0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 10.0}) {
    const Crumpled c(time);
    const Points root = c.body().mass.sqrt().replicate(1, 3);
    const Eigen::MatrixXd rates = matrix_of(c.body().points(), [&](const Points& u, Points& f) {
      c.body().add_dashpot_force(c.x, u / root, f);
      f /= -root;
    });
    const Eigen::MatrixXd left =
        matrix_of(c.body().points(), [&](const Points& u, Points& v) { v = c.kicked(0.02, c.none(), u / root) * root; });
    const Eigen::VectorXd eigenvalues = dense::eigenvalues(rates);
    const Eigen::MatrixXd modes = dense::eigenvectors(rates), shares = dense::product(modes.transpose(), dense::product(left, modes));
    for (int i = 0; i < shares.rows(); ++i) {
      const double z = 0.02 * eigenvalues[i], share = shares(i, i);
      CHECK(std::abs(share - std::exp(-z)) < 0.1);
      CHECK(z < 0.1 || std::abs(share) < 1 / z);
    }
  }
}

TEST(momentum_and_angular_momentum_are_the_outside_forces_and_rigid_motion_is_not_braked) {
  const Crumpled c(0.05);
  const Points v0 = c.scene.start.v, v1 = c.kicked(0.1, c.none(), v0);
  Vec3 momentum = Vec3::Zero(), angular = Vec3::Zero();
  Points rigid = c.none();
  const Vec3 velocity(1, -2, 0.5), spin(3, 1, -2);
  for (int p = 0; p < v0.rows(); ++p) {
    const Vec3 change = c.body().mass[p] * (row(v1, p) - row(v0, p));
    momentum += change;
    angular += row(c.x, p).cross(change);
    set_row(rigid, p, velocity + spin.cross(row(c.x, p)));
  }
  CHECK_NEAR(momentum.norm(), 0.0, 1e-14);
  CHECK_NEAR(angular.norm(), 0.0, 1e-14);
  CHECK_NEAR(distance(c.kicked(0.1, c.none(), rigid), rigid), 0.0, 1e-12);
}

TEST(what_it_says_it_took_is_missing) {
  const Crumpled c(0.002, true);
  DampedKick kick(c.body().points());
  kick.prepare(c.body(), 1e-3, c.body().fastest_damping);
  Points v = c.none();
  Points inner = c.none();
  c.body().add_dashpot_force(c.x, c.scene.start.v, inner);
  kick.apply(c.body(), c.x, inner, c.none(), c.scene.start.v, v);
  const double lost = kinetic(c.body(), c.scene.start.v) - kinetic(c.body(), v);
  CHECK_NEAR(kick.loss(c.body(), c.none(), c.none(), c.scene.start.v, v, false) / lost, 1.0, 1e-12);
}
