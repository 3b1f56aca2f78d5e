#include "contact/implicit/linear_contact.hpp"

#include "bodies.hpp"
#include "check.hpp"
#include "derivatives.hpp"
#include "random_numbers.hpp"

using namespace softffd;

namespace {

const Lattice brick{{3, 2, 3}};
constexpr int n = 18;
constexpr double h = 0.01, k = 500;

/// A body that has moved by u since the step began, under forces that are out of balance.
struct Setting {
  Body body = even_body(brick, k, n);
  Drive around = no_forces(n);
  Points x0 = rest_positions(brick), u{n, 3}, x{n, 3}, residual{n, 3};
  Scalars diagonal = Scalars::Constant(n, 800);  // positive definite with springs that are a fifth shorter

  Setting(Random& random, double friction, bool pinned) {
    if (pinned) body.pinned[0] = body.pinned[7] = true;
    around.planes = {{{.point = {0, 0, 0}, .normal = Vec3::UnitZ(), .friction = friction}},
                     {{.point = {0.05, 0, 0}, .normal = Vec3(1, 0.1, 0.2).normalized(), .friction = friction}},
                     {{.point = {0, 1.02, 0}, .normal = Vec3(0.1, -1, 0).normalized(), .friction = friction}}};
    x0.col(2) *= 0.8;
    for (int p = 0; p < n; ++p) {
      set_row(u, p, body.pinned[p] ? Vec3::Zero() : random.vector(0.02));
      set_row(residual, p, random.vector(30));
    }
    x = x0 + u;
  }

  StepProblem problem() const { return {body, x0, u, x, residual, diagonal, h, 1e-14, 30, k, 0, 0}; }

  /// A of the free points, dense, axis by axis.
  Eigen::MatrixXd matrix() const {
    Eigen::MatrixXd a = -matrix_of(n, [&](const Points& along, Points& f) { body.subtract_product(x, {.softening = 1}, along, f); });
    a.diagonal() += diagonal.replicate(3, 1).matrix();
    return a;
  }
};

/// What the planes do to the points according to the dense equations.
Points reaction(const Setting& s, const Points& change) {
  const Eigen::VectorXd made = s.matrix() * Eigen::Map<const Eigen::VectorXd>(change.data(), 3 * n);
  return Eigen::Map<const Points>(made.data(), n, 3) - s.residual;
}

const Holds no_holds;

}  // namespace

TEST(without_friction_it_is_the_solution_of_the_quadratic_programme) {
  Random random;
  int settled = 0, loaded = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const Setting s(random, 0, trial % 2);
    ContactSet contacts(brick, 3);
    contacts.open(s.body, s.around, 0, h, no_holds);
    LinearContact linear(brick);
    CHECK(linear.solve(s.problem(), contacts, false));
    if (!linear.settled) continue;
    ++settled;
    Points left = reaction(s, linear.change);
    for (int p = 0; p < n; ++p) {
      for (int i = 0; i < contacts.touches(p); ++i) {
        const ContactSet::Touch& touch = contacts.touch(p, i);
        loaded += touch.load > 1;
        CHECK(touch.load >= -1e-6);  // pulls below 1e-9 of the largest load are left alone
        CHECK_NEAR(contacts.plane(touch.plane).gap(row(s.x, p) + row(linear.change, p)), 0.0, 1e-13);
        set_row(left, p, row(left, p) - touch.load * touch.normal);
      }
      if (s.body.pinned[p]) {
        CHECK(row(linear.change, p).isZero(0));
        continue;
      }
      for (const HalfSpace& plane : contacts.planes()) CHECK(plane.gap(row(s.x, p) + row(linear.change, p)) >= -1e-13);
      CHECK_NEAR(row(left, p).norm(), 0.0, 1e-9);  // forces of 1e3 N
    }
  }
  CHECK(settled >= 95 && loaded > 300);
}

TEST(with_friction_loads_and_friction_solve_the_equations_together) {
  Random random;
  int settled = 0, sliding = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const double mu = 0.4;
    const Setting s(random, mu, false);
    ContactSet contacts(brick, 3);
    contacts.open(s.body, s.around, 0, h, no_holds);
    for (int p = 0; p < n; ++p)
      if (s.x0(p, 2) < 0.1) contacts.add(p, 0, 10);
    contacts.scale_friction(1, k);
    contacts.find_friction(s.x0, s.u, h, 0);
    LinearContact linear(brick);
    CHECK(linear.solve(s.problem(), contacts, false));
    if (!linear.settled) continue;
    ++settled;
    Points left = reaction(s, linear.change);
    for (int p = 0; p < n; ++p) {
      for (int i = 0; i < contacts.touches(p); ++i) {
        const ContactSet::Touch& touch = contacts.touch(p, i);
        const Vec3 friction = ContactSet::linear_friction(touch, row(linear.change, p));
        set_row(left, p, row(left, p) - touch.load * touch.normal - friction);
        if (touch.sticks || touch.load < 1) continue;
        ++sliding;
        CHECK_NEAR(touch.used, touch.load, 1e-3 * contacts.largest_load());  // the iterations end at 1e-4 of what was lacking
        CHECK_NEAR(touch.friction.norm(), mu * touch.used, 1e-9 * touch.used);
      }
      CHECK_NEAR(row(left, p).norm(), 0.0, 1e-8);  // forces of 1e3 N
    }
  }
  CHECK(settled >= 80 && sliding > 200);
}

TEST(indefinite_springs_are_taken_less_and_less) {
  Random random;
  Setting s(random, 0, false);
  s.x.col(0) = 0.1 * s.x.col(0).eval() + 0.3;  // crushed to a tenth: the exact matrix has no Cholesky factor
  s.u = s.x - s.x0;
  s.diagonal.setConstant(1);
  ContactSet contacts(brick, 3);
  contacts.open(s.body, s.around, 0, h, no_holds);
  LinearContact linear(brick);
  CHECK(dense::eigenvalues(s.matrix()).minCoeff() < -1);
  CHECK(linear.solve(s.problem(), contacts, false));
  CHECK(linear.change.isFinite().all());
  CHECK(linear.matrix().factorizations() > 1);
}
