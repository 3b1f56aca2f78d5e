#include "forces/cells.hpp"

#include "check.hpp"

using namespace softffd;

namespace {

Points crumpled(const Lattice& lattice, double amplitude) {
  Points x = rest_positions(lattice);
  for (int p = 0; p < x.rows(); ++p)
    for (int a = 0; a < 3; ++a) x(p, a) += amplitude * std::sin(7.0 * p + 3.0 * a);
  return x;
}

}  // namespace

TEST(a_mirrored_layer_folds_its_cells_and_no_others) {
  const Lattice lattice;
  const Cells cells(lattice);
  Points x = rest_positions(lattice);
  CHECK(cells.folded(x) == 0);
  for (int p = 48; p < 64; ++p) x(p, 2) = 0.5;  // the top layer under the one below it
  CHECK(cells.folded(x) == 9);
  x.col(0) *= -1;
  CHECK(cells.folded(x) == 18);
}

TEST(a_flat_cell_counts_as_folded) {
  const Lattice lattice{{2, 2, 2}};
  Points x = rest_positions(lattice);
  x.col(1) *= 0;
  CHECK(Cells(lattice).folded(x) == 1);
}

TEST(affine_maps_give_every_corner_their_determinant) {
  for (const Lattice& lattice : {Lattice{}, Lattice{{2, 3, 5}, {0.1, 0.2, 0.3}, {1e-3, 2, 70}}}) {
    const Cells cells(lattice);
    Points x = rest_positions(lattice);
    x.col(0) = 0.8 * x.col(0) + 0.3 * x.col(1) - 2.0;
    x.col(2) *= 0.5;
    CHECK(!cells.any_below(0.4 - 1e-12, x) && cells.any_below(0.4 + 1e-12, x));
    int count = 0;
    const Scalars& smallest = cells.smallest(x);
    for (int lane = 0; lane < cells.lanes(); ++lane)
      if (std::isfinite(smallest[lane])) {
        ++count;
        for (int number = 0; number < 8; ++number)
          CHECK_NEAR(cells.corner(x, lane, number & 1, number >> 1 & 1, number >> 2).volume, 0.4, 1e-12);
      }
    const auto& n = lattice.counts;
    CHECK(count == (n[0] - 1) * (n[1] - 1) * (n[2] - 1));
  }
}

TEST(the_smallest_of_a_cells_eight_corners_counts) {
  const Lattice lattice{{3, 2, 4}};
  const Cells cells(lattice);
  const Points x = crumpled(lattice, 0.3);
  const Scalars& found = cells.smallest(x);
  for (int lane = 0; lane < cells.lanes(); ++lane) {
    if (!std::isfinite(found[lane])) continue;
    double smallest = 1e300;
    for (int number = 0; number < 8; ++number)
      smallest = std::min(smallest, cells.corner(x, lane, number & 1, number >> 1 & 1, number >> 2).volume);
    CHECK_NEAR(found[lane], smallest, 1e-12);
  }
}

TEST(gradients_of_the_corners_are_those_of_their_volumes) {
  const Lattice lattice{{2, 2, 2}, Vec3::Zero(), {1, 2, 0.5}};
  const Cells cells(lattice);
  Points x = crumpled(lattice, 0.2);
  const double d = 1e-6;
  for (int number = 0; number < 8; ++number) {
    const auto volume = [&] { return cells.corner(x, 0, number & 1, number >> 1 & 1, number >> 2).volume; };
    const Cells::Corner corner = cells.corner(x, 0, number & 1, number >> 1 & 1, number >> 2);
    for (int i = 0; i < 4; ++i)
      for (int a = 0; a < 3; ++a) {
        double& here = x(corner.points[i], a);
        const double kept = here;
        here = kept + d;
        const double above = volume();
        here = kept - d;
        const double below = volume();
        here = kept;
        CHECK_NEAR(corner.gradient[i][a], (above - below) / (2 * d), 1e-8);  // of gradients of some 1 / m
      }
  }
}
