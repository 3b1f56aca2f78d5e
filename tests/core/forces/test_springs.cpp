#include "check.hpp"
#include "crumpled.hpp"
#include "forces/springs.hpp"

using namespace softffd;

namespace {

Springs make(const Lattice& lattice, Topology topology = Topology::distinct, Stiffness stiffness = {1000, 700, 300}) {
  Springs springs(lattice, topology);
  springs.set_stiffness(stiffness, {});
  return springs;
}

}  // namespace

TEST(spring_counts_are_the_published_ones) {
  CHECK(make({}).count() == 144 + 216 + 108);
  CHECK(make({}, Topology::paper).count() == 180 + 216 + 108);
  const Lattice small{{2, 2, 2}};
  CHECK(make(small).count() == 12 + 12 + 4);
  CHECK(make(small, Topology::paper).count() == 24 + 12 + 4);
  const Lattice uneven{{2, 3, 5}};
  CHECK(make(uneven).count() == (1 * 15 + 2 * 10 + 4 * 6) + 2 * (1 * 2 * 5 + 2 * 4 * 2 + 1 * 4 * 3) + 4 * 1 * 2 * 4);
}

TEST(the_rest_lattice_has_no_force_at_all) {
  const Lattice lattice{{4, 5, 3}, {0.1, 0.2, 0.3}, {1, 2, 0.7}};
  const Springs springs = make(lattice);
  Points f(lattice.points(), 3);
  springs.force(rest_positions(lattice), f);
  CHECK((f == 0).all());
}

TEST(force_is_minus_the_gradient_of_the_energy) {
  const Lattice lattice{{4, 3, 5}};
  const Springs springs = make(lattice, Topology::paper);
  Points x = crumpled(lattice), f(x.rows(), 3);
  springs.force(x, f);
  const double d = 1e-6;
  for (int p : {0, 7, 20, 59})
    for (int a = 0; a < 3; ++a) {
      const double here = x(p, a);
      x(p, a) = here + d;
      const double above = springs.energy(x);
      x(p, a) = here - d;
      const double below = springs.energy(x);
      x(p, a) = here;
      CHECK_NEAR(f(p, a), -(above - below) / (2 * d), 1e-5);  // differences of energies of some 100 J
    }
}

TEST(forces_add_up_to_nothing) {
  const Lattice lattice;
  const Springs springs = make(lattice);
  Points f(64, 3);
  springs.force(crumpled(lattice), f);
  for (int a = 0; a < 3; ++a) CHECK_NEAR(f.col(a).sum(), 0.0, 1e-10);
}

TEST(coinciding_points_give_finite_forces) {
  const Lattice lattice;
  const Springs springs = make(lattice);
  Points x = Points::Zero(64, 3), f(64, 3);
  springs.force(x, f);
  CHECK((f == 0).all());
}

TEST(a_region_needs_both_ends_and_the_last_one_wins) {
  const Lattice lattice;
  Springs springs(lattice, Topology::distinct);
  std::vector<bool> lower(64, false), pair(64, false);
  for (int p = 0; p < 16; ++p) lower[p] = true;
  pair[0] = pair[1] = true;
  springs.set_stiffness({1, 1, 1}, {{lower, 5}, {pair, 9}});
  const auto& edges = springs.rows()[0];
  CHECK(edges.stiffness[0] == 9 && edges.stiffness[1] == 5 && edges.stiffness[16] == 1);
  CHECK(springs.rows()[2].stiffness[0] == 1);
}
