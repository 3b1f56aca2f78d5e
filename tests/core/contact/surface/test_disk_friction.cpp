#include "contact/surface/disk_friction.hpp"

#include "check.hpp"
#include "model/plane.hpp"
#include "random_numbers.hpp"

using namespace softffd;

namespace {

/// Rows on planes with slips and limits; `solve` checks the law of friction.
struct Rubbing {
  Samples samples;
  Delassus rows;
  std::vector<Vec3> normals, slip;
  std::vector<double> limit;

  Rubbing(Random& random, int count, std::vector<Vec3> planes, double most)
      : samples(Basis::bezier, {}, places(random, count)), rows(samples), normals(std::move(planes)) {
    rows.set_normals(normals);
    rows.set_masses(Scalars::Constant(64, 64.0));
    std::vector<SurfaceRow> list;
    for (int q = 0; q < int(normals.size()); ++q)
      for (int s = q; s < count; s += int(normals.size())) list.push_back({q, s});
    rows.set_rows(list);
    for (const SurfaceRow& row : list) {
      slip.push_back(tangential(normals[row.plane], random.vector(1)));
      limit.push_back(std::max(0.0, random(-0.1, 1) * most));
    }
  }

  static std::vector<Vec3> places(Random& random, int count) {
    std::vector<Vec3> list;
    for (int s = 0; s < count; ++s) list.push_back(Vec3(0.5, 0.5, 0.5) + random.vector(0.5));
    return list;
  }

  void check() const {
    std::vector<Vec3> p(slip.size(), Vec3::Zero());
    DiskFriction friction;
    CHECK(friction.solve({rows, normals, limit, slip}, p) < 1e-12);
    for (int t = 0; t < int(p.size()); ++t) {
      Vec3 moved = Vec3::Zero();
      for (int u = 0; u < int(p.size()); ++u) moved += rows(t, u) * p[u];
      const Vec3 left = slip[t] + tangential(normals[rows.rows()[t].plane], moved);
      CHECK(p[t].norm() <= limit[t] * (1 + 1e-14));
      const bool inside = p[t].norm() < limit[t] * (1 - 1e-9);
      const Vec3 against = p[t] * left.norm() + left * limit[t];  // 0 where p is on the rim
      CHECK(inside ? left.norm() < 1e-9 : against.norm() < 1e-9 * (limit[t] + left.norm()));
    }
  }
};

}  // namespace

TEST(friction_on_a_plane_and_between_plates_is_within_its_disks_and_against_the_slip) {
  Random random, of_plates;
  for (int i = 0; i < 200; ++i) {
    Rubbing(random, 1 + i % 12, {random.direction()}, i % 4 == 0 ? 10 : 0.01 * (1 + i % 7)).check();
    if (i >= 100) continue;
    const Vec3 normal = of_plates.direction();
    const double most = i % 4 == 0 ? 10 : 0.02;
    Rubbing(of_plates, 2 + i % 10, {normal, -normal}, most).check();
  }
}
