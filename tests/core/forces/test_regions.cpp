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

double along_y(const Springs& springs, int i, Scalars Springs::Row::* values) {
  const Springs::Row& row = springs.rows()[1];
  return (row.*values)[thin.index(i, 0, 0) - row.begin];
}

}  // namespace

TEST(a_modulus_holds_in_cells_with_all_corners_in_the_region_and_the_last_region_wins) {
  Regions regions(
      thin, {{.points = layers(0, 2), .modulus = 9e3}, {.points = layers(1, 2), .modulus = 2e3}, {.points = layers(0, 0), .modulus = 7e3}});
  Springs springs(thin, Topology::distinct);
  regions.set_modulus(1e3, 0, springs);
  CHECK_NEAR(along_y(springs, 2, &Springs::Row::stiffness), 200, 1e-12);  // 0.4 E a / 4
  CHECK_NEAR(along_y(springs, 0, &Springs::Row::stiffness), 900, 1e-12);  // a region of one layer has no cell
  CHECK_NEAR(along_y(springs, 1, &Springs::Row::stiffness), 900 + 200, 1e-12);
  CHECK(!springs.dashpots());
}

TEST(internal_damping_of_a_modulus_is_that_of_cells) {
  Regions regions(thin, {{.points = layers(1, 2), .internal_damping = 3e-3}});
  Springs springs(thin, Topology::distinct);
  regions.set_modulus(1e3, 1e-3, springs);
  const double wanted[] = {0.1, 0.4, 0.3};  // the first cell's, both, the second one's
  for (int i = 0; i < 3; ++i) CHECK_NEAR(along_y(springs, i, &Springs::Row::dashpot), wanted[i], 1e-15);
  CHECK(springs.longest_time() == 3e-3);
}

TEST(internal_damping_of_a_stiffness_is_that_of_springs_with_both_ends_in_the_region) {
  const Regions regions(thin, {{.points = layers(1, 1), .internal_damping = 3e-3}, {.points = layers(2, 2), .stiffness = 50}});
  Springs springs(thin, Topology::distinct);
  regions.set_stiffness({100, 100, 100}, 1e-3, springs);
  const double wanted[] = {0.1, 0.3, 0.05};
  for (int i = 0; i < 3; ++i) CHECK_NEAR(along_y(springs, i, &Springs::Row::dashpot), wanted[i], 1e-15);
  CHECK(springs.rows()[0].dashpot[0] == 0.1);
}
