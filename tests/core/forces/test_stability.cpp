#include "body/stability.hpp"

#include "bodies.hpp"
#include "check.hpp"
#include "derivatives.hpp"

using namespace softffd;

TEST(uniform_lattice_has_its_known_frequency_and_a_tight_bound) {
  const Points x = rest_positions({});
  const Body body = even_body({}, 1e3);
  Stability stability(64);
  stability.prepare(body);
  CHECK_NEAR(highest_frequency(body, x), 930.848018037389, 1e-3);
  CHECK(stability.frequency(body, x) >= 930.848018037389 && stability.frequency(body, x) <= 1.21 * 930.848018037389);
}

TEST(bound_holds_whatever_the_shape_masses_and_pins) {
  for (int trial = 0; trial < 12; ++trial) {
    const Lattice lattice{{3, 4, 2}};
    Body body = even_body(lattice, 50);
    const Points x = scattered(lattice, 0.2, trial);
    for (int p = 0; p < body.points(); ++p) body.mass[p] = std::pow(10.0, 4 * scattered(7 * trial + p) - 3);
    if (trial % 2) body.pinned[trial] = body.pinned[2 * trial] = true;
    Stability stability(body.points());
    stability.prepare(body);
    const double truth = highest_frequency(body, x);
    CHECK(stability.frequency(body, x) >= truth * (1 - 1e-6));
    CHECK(stability.any_frequency() >= truth * (1 - 1e-6));
  }
}

TEST(one_light_point_is_bounded_sharply) {
  Body body = even_body({}, 1e3);
  body.mass[0] = 1e-6;
  Stability stability(64);
  stability.prepare(body);
  CHECK(stability.frequency(body, rest_positions({})) <= 1.2 * highest_frequency(body, rest_positions({})));
}

TEST(springs_that_share_no_point_are_bounded_exactly_in_any_direction) {
  const Lattice lattice{.counts = {2, 2, 2}, .size = {1, 2, 0.5}};
  Body body = even_body(lattice);
  springs_of(body).set_stiffness({0, 0, 50}, {});  // the four diagonals of the box
  const Points x = rest_positions(lattice);
  Stability stability(body.points());
  stability.prepare(body);
  CHECK_NEAR(stability.frequency(body, x), std::sqrt(2 * 50 / body.mass[0]), 1e-12);
  for (int p = 0; p < 4; ++p) body.pinned[p] = true;  // one end of each
  stability.prepare(body);
  CHECK_NEAR(stability.frequency(body, x), std::sqrt(50 / body.mass[0]), 1e-12);
}
