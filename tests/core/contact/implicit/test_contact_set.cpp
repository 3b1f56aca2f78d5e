#include "contact/implicit/contact_set.hpp"

#include "bodies.hpp"
#include "check.hpp"
#include "random_numbers.hpp"

using namespace softffd;

namespace {

const Lattice lattice{{2, 2, 2}};

/// For points of 1 kg.
ContactSet contacts_with(const std::vector<Plane>& planes, double h = 1e-3) {
  static const Holds none;
  Drive around = no_forces(8);
  around.planes = planes;
  ContactSet set(lattice, int(planes.size()));
  set.open(even_body(lattice, 0, 8), around, 0, h, none);
  return set;
}

/// Active set for points of unit stiffness without springs: where each of them ends that would go to x + wish.
bool settle(ContactSet& set, const Points& x, const Points& wish, Points& dx) {
  for (int round = 0; round < 40; ++round) {
    Points prescribed = x;
    set.prescribe(x, prescribed);
    dx = wish;
    for (int p : set.points()) set_row(dx, p, set.projector(p) * row(wish, p) + row(prescribed, p));
    set.find_loads(dx - wish, dx);
    const bool released = set.release_pulling(1e-12, round < 6);
    if (!set.add_violated(x + dx, 1e-13) && !released) return true;
  }
  return false;
}

std::vector<Plane> bowl(Random& random, int count) {
  std::vector<Plane> planes(count);
  for (Plane& plane : planes) {
    plane.normal = random.direction();
    plane.point = -random(0, 1) * plane.normal;  // the origin is in front of all
  }
  return planes;
}

}  // namespace

TEST(several_planes_on_one_point_are_the_exact_projection) {
  Random random;
  int settled = 0, touches[4] = {};
  const int trials = 500;
  for (int trial = 0; trial < trials; ++trial) {
    const std::vector<Plane> planes = bowl(random, 1 + trial % 5);
    ContactSet set = contacts_with(planes);
    Points x(8, 3), wish(8, 3), dx(8, 3);
    for (int p = 0; p < 8; ++p) set_row(x, p, random.vector(0.1)), set_row(wish, p, random.vector(3));
    if (!settle(set, x, wish, dx)) continue;
    ++settled;
    for (int p = 0; p < 8; ++p) {
      ++touches[set.touches(p)];
      // the nearest place in front of all planes: in front of them, pushed there by those that it is on
      const Vec3 end = row(x, p) + row(dx, p);
      for (const Plane& plane : planes) CHECK(plane.at(0).gap(end) >= -1e-12);
      Vec3 pushed = Vec3::Zero();
      for (int i = 0; i < set.touches(p); ++i) {
        const ContactSet::Touch& touch = set.touch(p, i);
        CHECK(touch.load >= 0);
        CHECK_NEAR(planes[touch.plane].at(0).gap(end), 0.0, 1e-12);
        pushed += touch.load * touch.normal;
      }
      CHECK_NEAR((pushed - (row(dx, p) - row(wish, p))).norm(), 0.0, 1e-9);  // of normals that may be nearly parallel
    }
  }
  CHECK(settled > 0.97 * trials);  // active sets may run in circles: implicit steps are halved then
  CHECK(touches[1] > 100 && touches[2] > 100 && touches[3] > 50);
}

TEST(of_planes_that_cannot_all_be_touched_the_least_loaded_goes) {
  const std::vector<Plane> planes{
      {{.normal = Vec3::UnitX()}}, {{.normal = Vec3::UnitY()}}, {{.normal = Vec3::UnitZ()}}, {{.normal = Vec3(1, 1, 1).normalized()}}};
  ContactSet set = contacts_with(planes);
  const double loads[] = {3, 1, 2, 0.5};
  for (int q = 0; q < 4; ++q) set.add(0, q, loads[q]);
  int touched = 0;
  for (int i = 0; i < set.touches(0); ++i) touched |= 1 << set.touch(0, i).plane;
  CHECK(set.touches(0) == 3 && touched == 0b1101);
  CHECK(set.freedom(0) == ContactSet::Freedom::none);
  ContactSet alike = contacts_with({planes[0], planes[0], planes[1], planes[1]});
  for (int q = 0; q < 4; ++q) alike.add(0, q, 1);
  CHECK(alike.touches(0) == 2);  // of the two that are alike one is enough
}

TEST(only_touches_that_pull_are_released_and_one_by_one_the_strongest_first) {
  for (const bool all : {true, false}) {
    ContactSet set = contacts_with({{{.normal = Vec3::UnitZ()}}});
    const double loads[] = {1, -1, -3, -1e-12};
    for (int p = 0; p < 4; ++p) set.add(p, 0, loads[p]);
    CHECK(set.release_pulling(1e-9, all));
    CHECK(set.touches(0) == 1 && set.touches(1) == (all ? 0 : 1) && set.touches(2) == 0 && set.touches(3) == 1);
  }
}

TEST(friction_stays_in_its_cone_and_against_the_slip) {
  Random random;
  const double h = 0.01, k = 1e4;
  int held = 0, sliding = 0;
  for (int trial = 0; trial < 300; ++trial) {
    std::vector<Plane> planes{{{.normal = random.direction(), .velocity = random.vector(1e-9), .friction = random(0, 1.5)}}};
    ContactSet set = contacts_with(planes, h);
    Points x0 = Points::Zero(8, 3), u(8, 3);
    double largest = 0;
    for (int p = 0; p < 8; ++p) {
      const double load = random(0, 10);
      largest = std::max(largest, planes[0].friction * load);
      set.add(p, 0, load);
      set_row(u, p, random.vector(1) * std::pow(10.0, random(-13, -4)));
    }
    set.scale_friction(1, k);
    set.find_friction(x0, u, h, 0);
    for (int p = 0; p < 8; ++p) {
      const ContactSet::Touch& touch = set.touch(p, 0);
      const double limit = planes[0].friction * touch.load;
      CHECK(touch.friction.norm() <= limit * (1 + 1e-14));
      CHECK_NEAR(touch.friction.dot(touch.normal), 0.0, 1e-12 * limit);  // rounding of the motion, of which the slip may be a small part
      CHECK(touch.friction.dot(touch.slip) <= 0);
      CHECK_NEAR((touch.slip - tangential(touch.normal, row(u, p) - h * planes[0].velocity)).norm(), 0.0, 1e-16);
      CHECK(touch.sticks || std::abs(touch.friction.norm() - limit) <= 1e-14 * limit);
      CHECK(!touch.sticks || touch.slip.norm() <= largest / (1e5 * k) + 1e-9);  // the elastic part is that short
      (touch.sticks ? held : sliding) += 1;
    }
  }
  CHECK(held > 300 && sliding > 300);
}

TEST(the_linear_friction_is_the_frictions_derivative) {
  Random random;
  const double h = 0.01;
  for (int trial = 0; trial < 100; ++trial) {
    ContactSet set = contacts_with({{{.normal = random.direction(), .friction = 0.5}}}, h);
    Points x0 = Points::Zero(8, 3), u(8, 3), more(8, 3);
    for (int p = 0; p < 8; ++p) set.add(p, 0, random(1, 10));
    set.scale_friction(1, 1e4);
    for (int p = 0; p < 8; ++p) {
      const double size = p < 4 ? 1e-11 : 1e-4;  // held and sliding
      set_row(u, p, random.vector(size));
      set_row(more, p, random.vector(1e-4 * size));
    }
    set.find_friction(x0, u, h, 0);
    set.fix_friction_stiffness(false);
    Points linear(8, 3);
    for (int p = 0; p < 8; ++p) set_row(linear, p, ContactSet::linear_friction(set.touch(p, 0), row(more, p)));
    set.find_friction(x0, u + more, h, 0);
    for (int p = 0; p < 8; ++p) CHECK_NEAR((row(linear, p) - set.touch(p, 0).friction).norm(), 0.0, 1e-6 * 5);  // second order in 1e-4
  }
}
