#include "forces/stability.hpp"

#include "check.hpp"
#include "hessian.hpp"

using namespace softffd;

namespace {

Body make(const Lattice& lattice, double k) {
  Body body{.springs = Springs(lattice, Topology::distinct), .mass = {}, .damping = {}, .pinned = {}};
  body.springs.set_stiffness({k, k, k}, {});
  body.mass = Scalars::Constant(lattice.points(), 1.0 / lattice.points());
  body.damping = Scalars::Zero(lattice.points());
  body.pinned.assign(lattice.points(), false);
  return body;
}

double pseudo_random(int i) { return 0.5 + 0.5 * std::sin(12.9898 * i * i + 78.233 * i); }

}  // namespace

TEST(uniform_lattice_has_its_known_frequency_and_a_tight_bound) {
  const Lattice lattice;
  const Body body = make(lattice, 1e3);
  Stability stability(64);
  stability.prepare(body);
  CHECK_NEAR(highest_frequency(body, rest_positions(lattice)), 930.848018037389, 1e-3);
  const double bound = stability.frequency(body, rest_positions(lattice));
  CHECK(bound >= 930.848018037389 && bound <= 1.21 * 930.848018037389);
}

TEST(bound_holds_whatever_the_shape_masses_and_pins) {
  for (int trial = 0; trial < 12; ++trial) {
    const Lattice lattice{{3, 4, 2}};
    Body body = make(lattice, 50);
    Points x = rest_positions(lattice);
    for (int i = 0; i < x.size(); ++i) x.data()[i] += 0.4 * (pseudo_random(100 * trial + i) - 0.5);
    for (int p = 0; p < body.points(); ++p) body.mass[p] = std::pow(10.0, 4 * pseudo_random(7 * trial + p) - 3);
    if (trial % 2) body.pinned[trial] = body.pinned[2 * trial] = true;
    Stability stability(body.points());
    stability.prepare(body);
    const double truth = highest_frequency(body, x);
    CHECK(stability.frequency(body, x) >= truth * (1 - 1e-6));
    CHECK(stability.any_frequency() >= truth * (1 - 1e-6));
  }
}

TEST(one_light_point_is_bounded_sharply) {
  const Lattice lattice;
  Body body = make(lattice, 1e3);
  body.mass[0] = 1e-6;
  Stability stability(64);
  stability.prepare(body);
  const double truth = highest_frequency(body, rest_positions(lattice));
  CHECK(stability.frequency(body, rest_positions(lattice)) <= 1.2 * truth);
}

TEST(springs_that_share_no_point_are_bounded_exactly_in_any_direction) {
  const Lattice lattice{.counts = {2, 2, 2}, .size = {1, 2, 0.5}};
  Body body = make(lattice, 0);
  body.springs.set_stiffness({0, 0, 50}, {});  // the four diagonals of the box
  const Points x = rest_positions(lattice);
  Stability stability(body.points());
  stability.prepare(body);
  CHECK_NEAR(stability.frequency(body, x), std::sqrt(2 * 50 / body.mass[0]), 1e-12);
  for (int p = 0; p < 4; ++p) body.pinned[p] = true;  // one end of each
  stability.prepare(body);
  CHECK_NEAR(stability.frequency(body, x), std::sqrt(50 / body.mass[0]), 1e-12);
}
