#include "forces/cells.hpp"

#include "bodies.hpp"
#include "check.hpp"
#include "derivatives.hpp"

using namespace softffd;

namespace {

Cells::Corner corner_of(const Cells& cells, const Points& x, int lane, int number) {
  return cells.corner(x, lane, number & 1, number >> 1 & 1, number >> 2);
}

}  // namespace

TEST(a_mirrored_layer_folds_its_cells_and_no_others_and_a_flat_cell_counts_as_folded) {
  const Lattice lattice;
  const Cells cells(lattice);
  Points x = rest_positions(lattice);
  CHECK(cells.folded(x) == 0);
  for (int p = 48; p < 64; ++p) x(p, 2) = 0.5;  // the top layer under the one below it
  CHECK(cells.folded(x) == 9);
  x.col(0) *= -1;
  CHECK(cells.folded(x) == 18);
  const Lattice one{{2, 2, 2}};
  Points flat = rest_positions(one);
  flat.col(1) *= 0;
  CHECK(Cells(one).folded(flat) == 1);
}

TEST(affine_maps_give_every_corner_their_determinant) {
  for (const Lattice& lattice : {Lattice{}, Lattice{{2, 3, 5}, {0.1, 0.2, 0.3}, {1e-3, 2, 70}}}) {
    const Cells cells(lattice);
    Points x = rest_positions(lattice);
    x.col(0) = 0.8 * x.col(0) + 0.3 * x.col(1) - 2.0;
    x.col(2) *= 0.5;
    CHECK(!cells.any_below(0.4 - 1e-12, x) && cells.any_below(0.4 + 1e-12, x));
    const Scalars& smallest = cells.smallest(x);
    CHECK(smallest.isFinite().count() == lattice.cells());
    for (int lane = 0; lane < cells.lanes(); ++lane)
      for (int number = 0; number < 8 && std::isfinite(smallest[lane]); ++number)
        CHECK_NEAR(corner_of(cells, x, lane, number).volume, 0.4, 1e-12);
  }
}

TEST(the_smallest_of_a_cells_eight_corners_counts) {
  const Lattice lattice{{3, 2, 4}};
  const Cells cells(lattice);
  const Points x = crumpled(lattice, 0.3);
  const Scalars& found = cells.smallest(x);
  for (int lane = 0; lane < cells.lanes(); ++lane) {
    double smallest = 1e300;
    for (int number = 0; number < 8 && std::isfinite(found[lane]); ++number)
      smallest = std::min(smallest, corner_of(cells, x, lane, number).volume);
    if (std::isfinite(found[lane])) CHECK_NEAR(found[lane], smallest, 1e-12);
  }
}

TEST(gradients_of_the_corners_are_those_of_their_volumes) {
  const Lattice lattice{{2, 2, 2}, Vec3::Zero(), {1, 2, 0.5}};
  const Cells cells(lattice);
  const Points x = crumpled(lattice);
  for (int number = 0; number < 8; ++number) {
    const Cells::Corner corner = corner_of(cells, x, 0, number);
    const Points slope = gradient(x, [&](const Points& at) { return corner_of(cells, at, 0, number).volume; });
    for (int i = 0; i < 4; ++i) CHECK_NEAR((corner.gradient[i] - row(slope, corner.points[i])).norm(), 0.0, 1e-8);  // of some 1 / m
  }
}
