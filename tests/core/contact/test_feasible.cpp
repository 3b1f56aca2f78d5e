#include "contact/feasible.hpp"

#include <random>

#include "check.hpp"

using namespace softffd;

namespace {

Constraint plane(const Vec3& normal, double bound, double friction = 0) {
  return {.normal = normal.normalized(), .bound = bound, .friction = friction};
}

}  // namespace

TEST(projection_is_feasible_and_optimal_in_random_cases) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  FeasibleSet feasible(4);
  int solved = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    std::vector<Constraint> constraints;
    const int count = 1 + trial % 4;
    const Vec3 inside(normal(random), normal(random), normal(random));  // makes the set not empty
    for (int q = 0; q < count; ++q) {
      const Vec3 n = Vec3(normal(random), normal(random), normal(random)).normalized();
      constraints.push_back(plane(n, n.dot(inside) - std::abs(normal(random)) * 0.3));
    }
    const Vec3 target(normal(random), normal(random), normal(random));
    Vec3 v = target;
    if (!feasible.project(constraints, 1e-13, v)) continue;
    ++solved;
    Vec3 rebuilt = target;
    for (const Constraint& c : constraints) {
      CHECK(c.normal.dot(v) >= c.bound - 1e-11);
      CHECK(c.normal_impulse >= 0);
      CHECK_NEAR(c.normal_impulse * (c.normal.dot(v) - c.bound), 0.0, 1e-9);  // complementarity
      rebuilt += c.normal_impulse * c.normal;
    }
    CHECK_NEAR((rebuilt - v).norm(), 0.0, 1e-10);
  }
  CHECK(solved == 3000);
}

TEST(orthogonal_planes_clip_each_axis) {
  FeasibleSet feasible(3);
  std::vector<Constraint> corner{plane(Vec3::UnitX(), 1), plane(Vec3::UnitY(), -1), plane(Vec3::UnitZ(), 0)};
  Vec3 v(-2, -3, -4);
  CHECK(feasible.project(corner, 0, v));
  CHECK(v == Vec3(1, -1, 0));
}

TEST(opposite_planes_that_leave_no_room_are_refused) {
  FeasibleSet feasible(2);
  std::vector<Constraint> closed{plane(Vec3::UnitZ(), 1), plane(-Vec3::UnitZ(), -0.5)};
  Vec3 v(0, 0, 0);
  CHECK(!feasible.project(closed, 1e-12, v));
  std::vector<Constraint> touching{plane(Vec3::UnitZ(), 1), plane(-Vec3::UnitZ(), -1)};
  CHECK(feasible.project(touching, 1e-12, v));
  CHECK_NEAR(v.z(), 1.0, 1e-15);
}

TEST(friction_holds_below_the_limit_and_slides_above_it) {
  FeasibleSet feasible(2);
  for (double tangential : {0.3, 2.0}) {
    std::vector<Constraint> ground{plane(Vec3::UnitZ(), 0, 0.5), plane(Vec3::UnitY(), -9, 0.5)};
    Vec3 v(tangential, 0, -1);
    CHECK(feasible.resolve(ground, 1e-14, v));
    CHECK_NEAR(v.x(), tangential <= 0.5 ? 0.0 : tangential - 0.5, 1e-12);
    CHECK_NEAR(v.z(), 0.0, 1e-13);
  }
}

TEST(friction_in_a_wedge_obeys_coulombs_disk) {
  FeasibleSet feasible(2);
  std::vector<Constraint> wedge{plane({1, 0, 1}, 0, 0.3), plane({-1, 0, 1}, 0, 0.3)};
  Vec3 v(0.2, 1.0, -1.0);
  CHECK(feasible.resolve(wedge, 1e-14, v));
  for (const Constraint& c : wedge) {
    CHECK(c.friction_impulse.norm() <= 0.3 * c.normal_impulse * (1 + 1e-6));
    CHECK_NEAR(c.friction_impulse.dot(c.normal), 0.0, 1e-14);
    CHECK(c.normal.dot(v) >= -1e-13);
  }
  CHECK(v.y() > 0 && v.y() < 1);
}
