#include "check.hpp"
#include "lattice.hpp"

using namespace softffd;

TEST(x_is_the_fastest_index) {
  const Lattice lattice;
  const Points rest = rest_positions(lattice);
  CHECK_NEAR(rest(lattice.index(1, 2, 3), 0), 1 / 3.0, 1e-16);
  CHECK_NEAR(rest(1 + 4 * 2 + 16 * 3, 1), 2 / 3.0, 1e-16);
  CHECK(rest(63, 2) == 1.0);
}

TEST(a_mirrored_layer_folds_its_cells_and_no_others) {
  const Lattice lattice;
  Points x = rest_positions(lattice);
  CHECK(folded_cells(lattice, x) == 0);
  for (int p = 48; p < 64; ++p) x(p, 2) = 0.5;  // the top layer under the one below it
  CHECK(folded_cells(lattice, x) == 9);
  x.col(0) *= -1;
  CHECK(folded_cells(lattice, x) == 18);
}
