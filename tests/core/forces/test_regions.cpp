#include "forces/regions.hpp"

#include "check.hpp"

using namespace softffd;

namespace {

const Lattice thin{{3, 2, 2}, {0, 0, 0}, {2, 1, 1}};  // two cells along x

std::vector<int> layers(int first, int last) {
  std::vector<int> points;
  for (int p = 0; p < thin.points(); ++p)
    if (p % 3 >= first && p % 3 <= last) points.push_back(p);
  return points;
}

double along_y(const Springs& springs, int i) {
  const Springs::Row& row = springs.rows()[1];
  return row.stiffness[thin.index(i, 0, 0) - row.begin];
}

}  // namespace

TEST(a_modulus_holds_in_cells_with_all_corners_in_the_region_and_the_last_region_wins) {
  Regions regions(
      thin, {{.points = layers(0, 2), .modulus = 9e3}, {.points = layers(1, 2), .modulus = 2e3}, {.points = layers(0, 0), .modulus = 7e3}});
  Springs springs(thin, Topology::distinct);
  regions.set_modulus(1e3, 0, springs);
  CHECK_NEAR(along_y(springs, 2), 200, 1e-12);  // 0.4 E a / 4
  CHECK_NEAR(along_y(springs, 0), 900, 1e-12);  // a region of one layer has no cell
  CHECK_NEAR(along_y(springs, 1), 900 + 200, 1e-12);
  CHECK(!springs.dashpots());
}
