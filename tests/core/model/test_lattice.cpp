#include "check.hpp"
#include "model/lattice.hpp"

using namespace softffd;

TEST(x_is_the_fastest_index) {
  const Lattice lattice;
  const Points rest = rest_positions(lattice);
  CHECK_NEAR(rest(lattice.index(1, 2, 3), 0), 1 / 3.0, 1e-16);
  CHECK_NEAR(rest(1 + 4 * 2 + 16 * 3, 1), 2 / 3.0, 1e-16);
  CHECK(rest(63, 2) == 1.0);
}
