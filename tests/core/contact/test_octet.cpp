#include "contact/octet.hpp"

#include "check.hpp"

using namespace softffd;

namespace {

const HalfSpace turning{{0.1, 0.2, 0.3}, {0.36, 0.48, 0.8}, 0.372, {0.3, -0.2, 0.5}, {0.4, 1, -0.7}};

/// Eight points of different masses on their way into a plane; every second one is on it already.
Octet approaching(const Approach& plane) {
  Octet octet;
  octet.clear(0);
  for (int lane = 0; lane < Octet::lanes; ++lane) {
    octet.add(3 * lane);
    const Vec3 aside(std::sin(lane), std::cos(2 * lane), std::sin(3 * lane)), flat = tangential(plane.start.normal, aside);
    const Vec3 x0 = plane.start.point + flat + (lane % 2 ? 0.0 : 0.01 * (lane + 1)) * plane.start.normal;
    const Vec3 v = 2 * flat - (1 + lane) * plane.start.normal;
    set_lane(octet.x0, lane, x0 - (lane % 2 ? plane.start.gap(x0) : 0.0) * plane.start.normal);
    set_lane(octet.before, lane, v);
    set_lane(octet.force, lane, 3 * aside);
    set_lane(octet.v, lane, v);
    set_lane(octet.x1, lane, x0 + plane.h * v);
    octet.mass[lane] = 0.1 * (lane + 1);
    octet.damping[lane] = 0.2;
    octet.opening[lane] = 1.1 * octet.mass[lane];
    octet.closing[lane] = 1.2 * octet.mass[lane];
  }
  return octet;
}

Octet met(const Approach& plane, const Octet& free, unsigned& landed) {
  Octet octet = free;
  landed = position_stage(plane, 1e-12, octet);
  return octet;
}

/// Are lanes a and b alike, to the bit?
bool same_lane(const Octet& octet, int a, const Octet& other, int b) {
  bool same = octet.work[a] == other.work[b] && octet.lost[a] == other.lost[b];
  for (auto part : {&Octet::x0, &Octet::before, &Octet::force, &Octet::x1, &Octet::v, &Octet::impulse, &Octet::torque, &Octet::received})
    same = same && lane_of(octet.*part, a) == lane_of(other.*part, b);
  return same;
}

}  // namespace

TEST(points_land_on_the_plane_and_go_with_it_or_slide_by_coulomb) {
  for (const double friction : {0.0, 0.3, 5.0}) {
    const Approach plane{turning, turning, turning, friction, 0.1};
    unsigned landed = 0;
    const Octet free = approaching(plane), octet = met(plane, free, landed);
    CHECK(landed == 0b01010101);
    bool stuck = false, slid = false;
    for (int lane = 0; lane < Octet::lanes; ++lane) {
      const Vec3 impulse = -lane_of(octet.impulse, lane), along = tangential(turning.normal, impulse);
      const double pushed = turning.normal.dot(impulse);
      CHECK_NEAR(turning.gap(lane_of(octet.x1, lane)), 0.0, 1e-15);
      CHECK(pushed > 0 && along.norm() <= friction * pushed + 1e-15);
      (along.norm() < (friction - 1e-12) * pushed ? stuck : slid) = true;
      CHECK_NEAR((lane_of(octet.torque, lane) + (lane_of(octet.x1, lane) - turning.point).cross(impulse)).norm(), 0.0, 1e-15);
      CHECK_NEAR(octet.work[lane], impulse.dot(turning.material_velocity(lane_of(octet.x1, lane))), 1e-15);
    }
    CHECK(stuck == (friction > 0) && slid == (friction < 1));
  }
}

TEST(momentum_of_those_that_stay_is_what_the_plane_receives) {
  const Approach plane{turning, turning, turning, 0.3, 0.1};
  unsigned landed = 0;
  const Octet free = approaching(plane);
  Octet octet = met(plane, free, landed);
  for (int lane = 1; lane < Octet::lanes; lane += 2) {
    const Vec3 change = lane_of(octet.v, lane) - lane_of(free.v, lane);
    CHECK_NEAR((octet.opening[lane] * change + lane_of(octet.impulse, lane)).norm(), 0.0, 1e-15);
  }
  const Octet before = octet;
  Points kicked = Points::Zero(24, 3), none = kicked;
  for (int lane = 0; lane < Octet::lanes; ++lane) set_row(kicked, octet.point[lane], lane_of(octet.v, lane));
  set_row(kicked, octet.point[2], lane_of(octet.v, 2) - 3 * turning.normal);
  set_row(kicked, octet.point[5], lane_of(octet.v, 5) + 3 * turning.normal);
  velocity_stage(plane, kicked, none, none, octet);
  for (int lane = 0; lane < Octet::lanes; ++lane) {
    const Vec3 slip = lane_of(octet.v, lane) - turning.material_velocity(lane_of(octet.x1, lane));
    CHECK(turning.normal.dot(slip) >= -1e-15);
    const Vec3 change = lane_of(octet.v, lane) - row(kicked, octet.point[lane]);
    CHECK_NEAR((octet.closing[lane] * change + lane_of(octet.impulse, lane)).norm(), 0.0, 1e-15);
    CHECK_NEAR((lane_of(octet.received, lane) - lane_of(before.received, lane) + lane_of(octet.impulse, lane)).norm(), 0.0, 1e-15);
  }
  CHECK(lane_of(octet.impulse, 5).isZero(0));
}

TEST(a_point_has_the_same_bits_in_every_lane) {
  const Approach plane{turning, turning, turning, 0.3, 0.1};
  unsigned landed = 0, other = 0;
  const Octet whole = approaching(plane), octet = met(plane, whole, landed);
  for (int lane = 0; lane < Octet::lanes; ++lane) {
    Octet alone;
    alone.clear(0);
    alone.add(whole.point[lane]);
    for (auto part : {&Octet::x0, &Octet::before, &Octet::force, &Octet::v, &Octet::x1})
      set_lane(alone.*part, 0, lane_of(whole.*part, lane));
    for (auto part : {&Octet::mass, &Octet::damping, &Octet::opening}) (alone.*part)[0] = (whole.*part)[lane];
    const Octet single = met(plane, alone, other);
    CHECK(other == (landed >> lane & 1));
    CHECK(same_lane(single, 0, octet, lane));
  }
}

TEST(an_end_and_the_next_beginning_at_once_are_both_to_the_last_bit_and_so_is_a_plane_that_is_known_to_rest) {
  const HalfSpace rests{turning.point, turning.normal, turning.offset, Vec3::Zero(), Vec3::Zero()};
  for (const double friction : {0.0, 0.3, 5.0})
    for (const Approach& plane : {Approach{turning, turning, turning, friction, 0.1}, Approach{rests, rests, rests, friction, 0.1, true}}) {
      unsigned landed = 0;
      Octet octet = met(plane, approaching(plane), landed), other = octet;
      Approach any = plane;
      any.still = false;
      const Octet unknown = met(any, approaching(any), landed);
      for (int lane = 0; lane < Octet::lanes; ++lane) CHECK(same_lane(octet, lane, unknown, lane));
      Points v(24, 3), spring(24, 3), outside(24, 3), x1 = Points::Zero(24, 3), w, y = x1;
      for (int i = 0; i < v.size(); ++i) v(i) = std::sin(i), spring(i) = std::cos(3 * i), outside(i) = std::sin(5 * i);
      w = v;
      close_step(plane, v, spring, outside, octet);
      open_step(plane.h, octet, x1);
      close_and_open(plane, w, spring, outside, other, y);
      CHECK((v == w).all() && (x1 == y).all());
      for (int lane = 0; lane < Octet::lanes; ++lane) CHECK(same_lane(octet, lane, other, lane));
    }
}

TEST(lanes_are_told_by_their_gaps) {
  Octet octet;
  for (int lane = 0; lane < Octet::lanes; ++lane) set_lane(octet.x1, lane, turning.point + (lane - 3) * turning.normal);
  set_lane(octet.x1, 7, Vec3::Constant(std::nan("")));
  const Sides found = sides(turning, octet, 1e-12);
  CHECK(found.at_least == 0b01110000 && found.at_most == 0b00001111);
}
