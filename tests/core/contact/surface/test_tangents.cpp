#include "contact/surface/tangents.hpp"

#include <algorithm>
#include <set>

#include "check.hpp"
#include "contact/tolerances.hpp"
#include "icosphere.hpp"
#include "random_numbers.hpp"

using namespace softffd;

namespace {

constexpr double slight = 1e-14;

/// A solid of each shape, anywhere.
std::vector<Plane> shapes(Random& random) {
  Plane sphere, cylinder, box;
  sphere.radius = random(0.1, 1);
  cylinder.radius = random(0.1, 1);
  cylinder.length = random(0.1, 2);
  box.sides = {random(0.1, 2), random(0.1, 2), random(0.1, 2)};
  box.rotation = random.vector(3);
  std::vector<Plane> all{sphere, cylinder, box};
  for (Plane& each : all) {
    each.point = random.vector(1);
    each.normal = each.box() ? Vec3::UnitZ() : random.direction();
  }
  return all;
}

/// Of a body whose surface is a sphere.
const Samples& round_samples() {
  static const Samples samples(Basis::bezier, {}, icosphere(2, 0.4, {0.5, 0.5, 0.5}));
  return samples;
}

bool holds(const Plane& solid, const SolidPose& pose, const Vec3& x) { return solid.holds(pose, x, slight); }

/// The solid over and over from one time to another, with its tangents at samples of the body.
struct Coming {
  Plane& solid;
  Tangents tangents{round_samples(), 1};
  int came = 0, looked = 0;

  void step(double t0, double t1, const Points& x, double way, const Points& next) {
    Drive around;
    around.planes = {solid};
    tangents.find(around, t0, t1, x, way);
    looked += int(tangents.found().size());
    std::set<int> has;
    for (const Tangent& each : tangents.found()) has.insert(each.sample);
    for (int s = 0; s < round_samples().count(); ++s) {
      if (!holds(solid, solid.pose_at(t1), round_samples().at(s, next))) continue;
      ++came;
      CHECK(has.contains(s));
    }
  }
};

void move(Plane& solid, Random& random) {
  solid.velocity = random.vector(1);
  solid.angular_velocity = random.vector(3);
  if (solid.box() && random(0, 1) < 0.5) solid.rotation_rate = random.vector(3);
}

}  // namespace

TEST(a_tangent_holds_the_whole_solid_and_touches_it_where_it_is_closest) {
  Random random;
  int outside = 0, inside = 0;
  for (int trial = 0; trial < 3000; ++trial)
    for (const Plane& solid : shapes(random)) {
      const SolidPose pose = solid.pose_at(0);
      const Vec3 x = pose.point + random.vector(1);
      const HalfSpace facing = tangent(solid, pose, x);
      const double gap = facing.gap(x);
      CHECK_NEAR(facing.normal.norm(), 1, slight);
      CHECK(holds(solid, pose, x - gap * facing.normal));
      CHECK((gap <= slight) == holds(solid, pose, x) || std::abs(gap) < 2 * slight);
      (gap > 0 ? outside : inside) += 1;
      for (int n = 0; n < 20; ++n) {
        const Vec3 other = pose.point + random.vector(1.5);
        CHECK(!holds(solid, pose, other) || facing.gap(other) <= slight);
      }
    }
  CHECK(outside > 1000 && inside > 500);
}

TEST(what_is_in_a_box_goes_out_by_the_nearest_face_and_before_a_face_the_tangent_is_its_plane_to_the_bit) {
  Plane box;
  box.sides = {2, 1, 4};
  const SolidPose pose = box.pose_at(0);
  CHECK(tangent(box, pose, {0.9, 0.3, 1.0}).normal == Vec3(1, 0, 0));
  CHECK(tangent(box, pose, {0.2, -0.3, 1.0}).normal == Vec3(0, -1, 0));
  CHECK(tangent(box, pose, {0.2, 0.3, -1.9}).normal == Vec3(0, 0, -1));
  CHECK_NEAR(tangent(box, pose, {0.2, 0.3, -1.9}).gap({0.2, 0.3, -1.9}), -0.1, slight);
  Random random;
  box.point = {0.1, 0.2, -2};  // not turned
  for (int trial = 0; trial < 100; ++trial) {
    const HalfSpace facing = tangent(box, box.pose_at(0), Vec3(random(-0.8, 1), random(-0.2, 0.6), random(1e-17, 1)));
    CHECK(facing.normal == Vec3::UnitZ() && facing.offset == 0);
  }
}

TEST(tangents_go_with_their_solid) {
  Random random;
  const Points x = rest_positions({});
  int found = 0;
  for (int trial = 0; trial < 100; ++trial)
    for (Plane& solid : shapes(random)) {
      move(solid, random);
      Drive around;
      around.planes = {solid};
      Tangents tangents(round_samples(), 1);
      tangents.find(around, 0, 0.1, x, 0.1);
      const SolidPose start = solid.pose_at(0), end = solid.pose_at(0.1);
      for (const Tangent& each : tangents.found()) {
        ++found;
        const Vec3 centre = start.point;
        CHECK_NEAR(each.start.gap(centre), each.end.gap(end.point), 10 * slight);
        if (solid.box())
          CHECK_NEAR((start.edges.transpose() * each.start.normal - end.edges.transpose() * each.end.normal).norm(), 0, slight);
        if (solid.length > 0) CHECK_NEAR(start.normal.dot(each.start.normal), end.normal.dot(each.end.normal), 10 * slight);
        CHECK(each.end.spin == end.spin && each.end.velocity == end.velocity);
      }
    }
  CHECK(found > 1000);
}

TEST(every_sample_that_comes_to_a_solid_has_a_tangent) {
  Random random;
  const double h = 0.01, way = 0.02;
  int came = 0, looked = 0;
  for (int trial = 0; trial < 20; ++trial)
    for (Plane& solid : shapes(random)) {
      move(solid, random);
      solid.point = Vec3(0.5, 0.5, 0.5) + 1.2 * random.direction();
      Coming coming{solid};
      Points x = rest_positions({});
      for (int step = 0; step < 50; ++step) {
        Points next = x;
        for (int p = 0; p < 64; ++p) set_row(next, p, row(x, p) + random(0, way) * random.direction());
        coming.step(step * h, (step + 1) * h, x, way, next);
        x = next;
      }
      came += coming.came;
      looked += coming.looked;
    }
  CHECK(came > 1000 && looked < 20 * 3 * 50 * round_samples().count() / 2);
}

TEST(a_solid_that_turns_beside_a_body_at_rest_is_seen_when_it_comes) {
  const Points x = rest_positions({});
  Plane cylinder, box;
  cylinder.radius = 0.05;
  cylinder.length = 1.8;
  cylinder.normal = Vec3::UnitY();
  box.sides = {0.1, 1.8, 0.1};
  for (Plane& solid : {std::ref(cylinder), std::ref(box)}) {
    solid.point = {-0.5, 0.5, 0.5};
    solid.angular_velocity = {0, 0, -1};
    Coming coming{solid};
    for (int step = 0; step < 160; ++step) coming.step(0.01 * step, 0.01 * (step + 1), x, 0, x);
    CHECK(coming.came > 20);
  }
}

TEST(a_box_turns_with_the_angular_velocity_that_it_has) {
  Random random;
  for (int trial = 0; trial < 200; ++trial) {
    Plane box;
    box.sides = {1, 0.5, 0.2};
    box.rotation = random.vector(3);
    move(box, random);
    const double d = 1e-5;
    const SolidPose now = box.pose_at(0.3), before = box.pose_at(0.3 - d), after = box.pose_at(0.3 + d);
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 rate = (after.edges.col(axis) - before.edges.col(axis)) / (2 * d);
      CHECK_NEAR((rate - now.spin.cross(now.edges.col(axis))).norm(), 0, 1e-7);  // d^2 and rounding over d
    }
    const double size = box.size(), speed = way_between(box, 0, 0.5, size).speed;
    const Vec3 corner = 0.5 * box.sides;
    const SolidPose start = box.pose_at(0), end = box.pose_at(0.5);
    CHECK((end.point + end.edges * corner - start.point - start.edges * corner).norm() <= 0.5 * speed);
  }
}
