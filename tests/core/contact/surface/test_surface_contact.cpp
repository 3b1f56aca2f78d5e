#include "random_numbers.hpp"
#include "surface_bodies.hpp"

using namespace softffd;

namespace {

/// A sphere that is let go of 0.05 above where a rigid one would rest in a groove of so many degrees along y.
SoftBody in_groove(double degrees, double friction, double h) {
  const double half = 0.5 * degrees * 3.14159265358979323846 / 180, rigid = 0.4 / std::sin(half);
  SoftBody body = Sphere{.level = 3, .height = rigid - 0.4 + 0.05, .damping = 0.5, .friction = friction, .planes = 2}.body();
  for (const int side : {0, 1}) {
    body.settings.planes[side].point = {0.5, 0, 0};
    body.settings.planes[side].normal = {(side ? -1 : 1) * std::cos(half), 0, std::sin(half)};
  }
  body.settings.step = h;
  CHECK(body.initialize(0) == StepStatus::ok);
  return body;
}

}  // namespace

TEST(friction_in_a_groove_stays_within_its_cone_and_converges) {
  const Sphere sphere{.level = 3};
  const Samples samples = sphere.samples();
  for (const double friction : {0.3, 1.0})
    for (const double degrees : {90.0, 30.0}) {
      std::vector<Points> ends;
      for (const double h : {1e-3, 2.5e-4}) {
        SoftBody body = in_groove(degrees, friction, h);
        for (int step = 0; step < 100; ++step) {
          CHECK(body.advance(0.01) == StepStatus::ok);
          for (const int side : {0, 1}) {
            const Vec3 force = body.readings().plane_reaction(side), normal = body.settings.planes[side].normal;
            CHECK(tangential(normal, force).norm() <= friction * -force.dot(normal) + 1e-9);
            for (int s = 0; s < samples.count(); ++s)
              CHECK(normal.normalized().dot(samples.at(s, body.state().x) - body.settings.planes[side].point) >= -1e-12);
          }
        }
        ends.push_back(body.state().x);
      }
      CHECK(distance(ends[0], ends[1]) < 1e-3);
    }
}

TEST(a_plane_that_jumps_takes_the_whole_body_along) {
  SoftBody body = Sphere{.level = 2}.body();
  body.settings.planes[0].moved_by_input = true;
  body.settings.step = 1e-3;
  body.initialize(0);
  go(body, 100, 0.01);
  const double before = body.readings().elastic_energy(), height = centre(body).z();
  body.settings.planes[0].point.z() = 0.05;
  CHECK(body.advance(1e-3) == StepStatus::ok);
  CHECK_NEAR(centre(body).z(), height + 0.05, 1e-4);
  CHECK_NEAR(body.readings().elastic_energy(), before, 0.01);
}

TEST(a_start_behind_a_plane_is_moved_out_and_does_not_fling_the_body) {
  SoftBody body = Sphere{.level = 2, .height = -0.15}.body();
  body.settings.step = 1e-3;
  CHECK(body.initialize(0) == StepStatus::ok);
  CHECK(body.readings().elastic_energy() < 1e-20);
  CHECK_NEAR(lowest(Sphere{.level = 2}.samples(), body), 0, 1e-12);
  go(body, 100, 0.01);
  CHECK(centre(body).z() < 0.42);
}

TEST(a_lattice_behind_the_plane_whose_surface_is_not_flies_as_if_there_was_none) {
  std::vector<Points> ends;
  for (const int planes : {0, 1})
    for (const double step : {1e-3, 0.0}) {
      SoftBody body = Sphere{.level = 2, .height = 0.01, .velocity = {1, 0, 0}, .planes = planes}.body(Vec3(0, 0, 2));
      body.settings.gravity.setZero();
      body.settings.step = step;
      body.initialize(0);
      go(body, 10, 0.01);
      if (planes)
        CHECK(body.state().x.col(2).minCoeff() < -0.05 && body.readings().plane_reaction(0).isZero(0) && body.run().contacts[0] == 0);
      if (step > 0) ends.push_back(body.state().x);
    }
  CHECK((ends[0] == ends[1]).all());
}

namespace {

/// A body, planes and a start of no pattern.
struct Thrown {
  Definition definition;
  Settings settings;
  std::vector<Vec3> places;
};

Thrown thrown(Random& random, bool still, int n, Basis basis) {
  Thrown all;
  Definition& d = all.definition;
  d.lattice.counts = {n, n, n};
  for (int p = 0; p < n * n * n; ++p) d.mass.push_back(random(0.3, 2) / (n * n * n));
  d.planes = 1 + int(random(0, 4));
  d.velocity = random.vector(3);
  d.angular_velocity = random.vector(4);
  const int count = 4 + int(random(0, 200));
  for (int s = 0; s < count; ++s) all.places.push_back(Vec3(0.5, 0.5, 0.5) + random.vector(0.5));
  d.samples = std::make_shared<Samples>(basis, d.lattice, all.places);
  const double k = random(500, 2e4);
  all.settings.stiffness = {k, k, k};
  all.settings.step = random(2e-4, 1e-3);
  if (!still) all.settings.gravity = random.vector(15);
  for (int q = 0; q < d.planes; ++q) {
    const Vec3 normal = random.direction();
    PlaneMotion plane{.point = Vec3(0.5, 0.5, 0.5) - normal * random(0.6, 1.2), .normal = normal, .friction = random(-0.4, 1.2)};
    if (!still) plane.velocity = random.vector(0.5), plane.angular_velocity = random.vector(0.6);
    plane.friction = std::max(plane.friction, 0.0);
    all.settings.planes.push_back(plane);
  }
  return all;
}

SoftBody body_of(const Thrown& all) {
  SoftBody body(all.definition);
  static_cast<Material&>(body.settings) = all.settings;
  body.settings.gravity = all.settings.gravity;
  body.settings.step = all.settings.step;
  body.settings.planes = all.settings.planes;
  CHECK(body.initialize(0) == StepStatus::ok);
  return body;
}

}  // namespace

TEST(no_sample_is_ever_behind_a_plane_and_planes_at_rest_add_no_energy) {
  Random random;
  Count contacts = 0;
  for (int i = 0; i < 60; ++i) {
    const bool still = i % 2 == 1;
    const Thrown all = i % 5 == 4 ? thrown(random, still, 6, Basis::bspline) : thrown(random, still, 4, Basis::bezier);
    SoftBody body = body_of(all);
    const double begin = body.readings().kinetic_energy() + body.readings().elastic_energy();
    for (int step = 0; step < 40; ++step) {
      CHECK(body.advance(0.01) == StepStatus::ok);
      for (const PlaneMotion& motion : all.settings.planes) {
        Plane plane;
        static_cast<PlaneMotion&>(plane) = motion;
        const HalfSpace obstacle = plane.at(body.state().time);
        for (std::size_t s = 0; s < all.places.size(); ++s)
          CHECK(obstacle.gap(all.definition.samples->at(int(s), body.state().x)) >= -1e-12);
      }
      if (still) CHECK(body.readings().kinetic_energy() + body.readings().elastic_energy() < 1.003 * begin);
    }
    contacts += body.run().contacts_resolved;
  }
  CHECK(contacts > 2'000);
}

TEST(the_order_of_samples_does_not_matter) {
  Random random;
  for (int i = 0; i < 6; ++i) {
    Thrown all = thrown(random, i % 2 == 1, 4, Basis::bezier);
    SoftBody body = body_of(all);
    std::reverse(all.places.begin(), all.places.end());
    all.definition.samples = std::make_shared<Samples>(Basis::bezier, all.definition.lattice, all.places);
    SoftBody other = body_of(all);
    for (SoftBody* each : {&body, &other}) go(*each, 20, 0.01);
    CHECK(distance(body.state().x, other.state().x) < 1e-9);
  }
}

TEST(a_cube_in_a_corner_without_friction_presses_with_each_part_of_its_weight) {
  SoftBody body = cube(3, 2e3, 4);
  body.settings.planes[0] = {.point = {0.05, 0, 0}, .normal = Vec3::UnitX()};
  body.settings.planes[1] = {.point = {0, 0.05, 0}, .normal = Vec3::UnitY()};
  body.settings.gravity = {-3, -4, -9.81};
  body.settings.damping = 0.3;
  body.settings.step = 1e-3;
  body.initialize(0);
  go(body, 200, 0.01);
  for (int q = 0; q < 3; ++q) CHECK((body.readings().plane_reaction(q) - body.settings.gravity[q] * Vec3::Unit(q)).norm() < 1e-6);
}
