#include "forces/light_points.hpp"

#include <cmath>
#include <limits>

#include "check.hpp"

using namespace softffd;

namespace {

constexpr double any = std::numeric_limits<double>::infinity();

struct Light {
  Lattice lattice{{4, 3, 3}};
  Springs springs{lattice, Topology::distinct};
  Scalars mass = Scalars::Constant(36, 1.0 / 36);
  std::vector<bool> pinned = std::vector<bool>(36, false);

  explicit Light(double k = 1e3) { springs.set_stiffness({k, k, k}, {}); }
  double raise(double most, double period = any) { return raise_light_points(springs, pinned, most, period, mass).moved; }
  double fastest() const {  // omega^2 by the springs at each point
    Scalars stiffness = Scalars::Zero(36);
    for (const Springs::Row& row : springs.rows())
      for (int lane = 0; lane < row.lanes(); ++lane) {
        stiffness[row.begin + lane] += row.stiffness[lane];
        if (row.stiffness[lane] > 0) stiffness[row.begin + lane + row.offset] += row.stiffness[lane];
      }
    return (stiffness / mass).maxCoeff();
  }
};

}  // namespace

TEST(points_alike_keep_their_masses_to_the_bit) {
  for (const double mass : {1.0 / 36, 0.2 / 36}) {  // lighter, but no light point
    Light body;
    body.mass[7] = mass;
    const Scalars before = body.mass;
    CHECK(body.raise(0.3) == 0 && (before == body.mass).all());
  }
}

TEST(a_light_point_gets_a_twentieth_of_a_mean_mass_at_most_and_its_neighbours_pay) {
  Light body;
  body.mass[0] = 1e-9;
  const double others = Light().fastest(), total = body.mass.sum(), before = body.fastest();
  const double moved = body.raise(0.3);
  CHECK(before > 1e6 * others);
  CHECK(body.fastest() < 6 * others);
  CHECK_NEAR(body.mass.sum(), total, 1e-15);
  CHECK_NEAR(body.mass[0] - 1e-9, moved, 1e-15);
  int paid = 0;
  for (int p = 1; p < 36; ++p) paid += body.mass[p] < 1.0 / 36;
  CHECK(paid == 7);  // the corner's neighbours
}

TEST(what_is_moved_and_what_it_swings_by_have_bounds) {
  for (const double most : {1e-4, 3e-6}) {
    Light body;
    body.mass[0] = body.mass[35] = 1e-8;
    const double moved = body.raise(most);
    CHECK(moved > 0.9 * most && moved <= most);
  }
  for (const double period : {1e-4, 3e-5}) {
    Light body;
    body.mass[0] = 1e-8;
    body.raise(1e-3, period);
    CHECK_NEAR(body.fastest() * period * period, 1, 1e-9);
  }
}

TEST(nothing_is_moved_where_steps_would_hardly_be_longer_or_nobody_can_pay) {
  Light hardly;
  hardly.mass[0] = 1e-6;
  CHECK(hardly.raise(3e-6) == 0);
  CHECK(hardly.raise(6e-6) > 0);
  Light held;
  held.mass[0] = 1e-8;
  held.pinned[0] = true;
  CHECK(held.raise(1e-4) == 0);
  held.pinned[0] = false;
  for (int p = 1; p < 36; ++p) held.pinned[p] = p % 4 != 3;  // all that could pay
  CHECK(held.raise(1e-4) == 0);
}

TEST(light_points_within_both_bounds_are_slight) {
  for (const double period : {1e-6, 1e-4}) {
    Light body;
    body.mass[0] = 1e-7;   // swings within 4e-6 s
    body.mass[35] = 1e-4;  // heavier than what may be moved
    const LightPoints found = raise_light_points(body.springs, body.pinned, 3e-6, period, body.mass);
    CHECK(found.slight == (period < 4e-6 ? std::vector<int>{} : std::vector<int>{0}));
  }
}
