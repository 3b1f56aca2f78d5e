#include "bodies.hpp"
#include "check.hpp"
#include "derivatives.hpp"
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
  springs.set_force(rest_positions(lattice), f);
  CHECK((f == 0).all());
}

TEST(force_is_minus_the_gradient_of_the_energy_and_adds_up_to_nothing) {
  const Lattice lattice{{4, 3, 5}};
  const Springs springs = make(lattice, Topology::paper);
  const Points x = crumpled(lattice);
  Points f(x.rows(), 3);
  springs.set_force(x, f);
  const Points slope = gradient(x, [&](const Points& at) { return springs.energy(at); });
  CHECK_NEAR(distance(f, -slope), 0.0, 1e-5);  // differences of energies of some 100 J
  for (int a = 0; a < 3; ++a) CHECK_NEAR(f.col(a).sum(), 0.0, 1e-10);
  springs.set_force(Points::Zero(x.rows(), 3), f);  // all at one place
  CHECK((f == 0).all());
}
