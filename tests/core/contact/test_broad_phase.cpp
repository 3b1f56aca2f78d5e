#include "contact/broad_phase.hpp"

#include "bodies.hpp"
#include "check.hpp"
#include "random_numbers.hpp"

using namespace softffd;

namespace {

constexpr int samples = 100;
constexpr double H = 0.1;

/// Eight points without springs in free flight under constant forces, and planes that move steadily.
struct Flight {
  Body body = even_body({{2, 2, 2}});
  Drive around = no_forces(8);
  State state = at_rest({{2, 2, 2}});

  Flight(Random& random, int trial, bool steady = true) {
    body.mass.setConstant(random(0.1, 2));
    const double fast = random(0, 1) < 0.3 ? 0 : random(0, 10), forced = random(0, 1) < 0.3 ? 0 : random(0, 100);
    for (int i = 0; i < 24; ++i) {
      state.x(i) = random(-1, 1);
      state.v(i) = fast * random(-1, 1);
      around.force(i) = forced * random(-1, 1);
    }
    const int planes = 1 + int(random(0, 3));
    for (int q = 0; q < planes; ++q) {
      Plane plane;
      plane.normal = random.direction();
      double lowest = 1e300;
      for (int p = 0; p < 8; ++p) lowest = std::min(lowest, plane.normal.dot(row(state.x, p)));
      plane.point = (lowest - random(0, 1) * random(0, trial % 2 ? 1 : 10)) * plane.normal;
      if (random(0, 1) < 0.7) plane.velocity = random(0, 10) * random.direction();
      if (!steady) unsettle(plane, random);
      around.planes.push_back(plane);
    }
  }

  Points x(double t) const { return state.x + t * state.v + 0.5 * t * t * acceleration(); }
  Points v(double t) const { return state.v + t * acceleration(); }
  double least_gap(double t) const {
    const Points now = x(t);
    double least = 1e300;
    for (const Plane& plane : around.planes) {
      const HalfSpace half = plane.at(t);
      for (int p = 0; p < 8; ++p) least = std::min(least, half.gap(row(now, p)));
    }
    return least;
  }
  bool meets() const {
    for (int i = 0; i <= samples; ++i)
      if (least_gap(i * H / samples) < 0) return true;
    return false;
  }

  /// A plane that accelerates, and turns about a point of its own or follows a rate of its normal.
  static void unsettle(Plane& plane, Random& random) {
    plane.point += random(0, 3) * plane.normal.unitOrthogonal();
    if (random(0, 1) < 0.5) plane.acceleration = random(0, 300) * random.direction();
    if (random(0, 1) < 0.4)
      plane.normal_rate = random(0, 15) * random.direction();
    else if (random(0, 1) < 0.6)
      plane.angular_velocity = random(0, 20) * random.direction();
    if (random(0, 1) < 0.5) plane.angular_acceleration = random(0, 300) * random.direction();
  }

 private:
  Points acceleration() const { return around.force / body.mass[0]; }
};

/// Flights at random: `sees(reach, flight)` must be so wherever one meets a plane. How many of those meetings are `hard`, and how many
/// flights are seen.
template <class Sees, class Hard>
std::pair<int, int> count(bool steady, Sees&& sees, Hard&& hard) {
  Random random;
  BroadPhase reach(8);
  int met = 0, seen = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const Flight flight(random, trial, steady);
    const bool sight = sees(reach, flight), meets = flight.meets();
    CHECK(sight || !meets);
    met += meets && hard(flight);
    seen += sight;
  }
  return {met, seen};
}

bool may_touch(BroadPhase& reach, const Flight& flight) {
  const Equations equations{flight.body, flight.around};
  return reach.may_touch(equations, flight.state, H, forecast_way(equations, flight.state, H));
}

/// What starts behind a plane counts as seen.
bool passed(BroadPhase& reach, const Flight& flight) {
  return flight.least_gap(0) < 0 || reach.passed(flight.around, 0, H, flight.x(0), flight.v(0), flight.x(H), flight.v(H));
}
bool only_in_between(const Flight& flight) { return flight.least_gap(0) >= 0 && flight.least_gap(H) >= 0; }

}  // namespace

/// Neither all nor nothing is seen.
TEST(whatever_meets_a_plane_was_within_reach_or_is_seen_from_both_ends_also_where_planes_accelerate_and_turn) {
  const auto [meeting, within] = count(true, may_touch, [](const Flight&) { return true; });
  CHECK(meeting > 500 && within < 2500);
  const auto [behind, seen] = count(true, passed, only_in_between);
  CHECK(behind > 5 && seen < 2700);
  const auto [coming, within_then] = count(false, may_touch, only_in_between);
  CHECK(coming > 20 && within_then < 2900);
  const auto [turning, seen_then] = count(false, passed, only_in_between);
  CHECK(turning > 20 && seen_then < 2900);
}

namespace {

/// A point that goes to and fro along z, and what a plane at z = depth sees of a step from t0 on.
bool swing_passes(double amplitude, double omega, double t0, double h, double depth) {
  BroadPhase reach(1);
  const auto at = [&](double t, bool rate) {
    Points now = Points::Zero(1, 3);
    now(2) = amplitude * (rate ? omega * std::cos(omega * t) : std::sin(omega * t));
    return now;
  };
  Drive around;
  around.planes.push_back({{.point = {0, 0, depth}}});
  return reach.passed(around, t0, t0 + h, at(t0, false), at(t0, true), at(t0 + h, false), at(t0 + h, true));
}

}  // namespace

TEST(a_point_that_swings_in_and_out_is_seen_from_both_ends) {
  for (const double turned : {0.5, 1.0, 2.0, 3.0, 4.0})  // of the swing, in a step [rad]
    for (double t0 = 0; t0 < 6.3; t0 += 0.05) {
      double lowest = 1;
      for (int i = 0; i <= 400; ++i) lowest = std::min(lowest, std::sin(t0 + turned * i / 400));
      CHECK(swing_passes(1, 1, t0, turned, lowest + 1e-3));
    }
}

TEST(on_a_plane_is_not_off_it) {
  Random random;
  Flight flight(random, 0);
  flight.around.planes.resize(1);
  Plane& plane = flight.around.planes[0];
  plane = {{.normal = Vec3::UnitZ()}};
  for (const double gap : {1e-3, 1e-11}) {
    plane.point.z() = flight.state.x.col(2).minCoeff() - gap;
    CHECK(off_obstacles(flight.around, 0, flight.state.x, 1e-12));
  }
  for (const double gap : {0.0, 1e-13, -1e-3}) {
    plane.point.z() = flight.state.x.col(2).minCoeff() - gap;
    CHECK(!off_obstacles(flight.around, 0, flight.state.x, 1e-12));
  }
  flight.state.x(3, 1) = std::nan("");
  plane.point.z() = -10;
  CHECK(!off_obstacles(flight.around, 0, flight.state.x, 1e-12));
}

/// The points of a lattice that no power of two divides.
TEST(points_behind_a_plane_are_those_of_negative_gaps) {
  const int n = 27;
  const Vec3 normal(0.36, 0.48, 0.8);
  Points x(n, 3);
  for (int i = 0; i < x.size(); ++i) x(i) = std::sin(3.0 * i);
  Scalars gap(n);
  std::array<unsigned char, 4> bits{};
  for (const double offset : {0.1, -2.0}) {
    const bool any = kernels::gaps(n, x.data(), normal.data(), offset, gap.data());
    CHECK(kernels::behind(n, x.data(), normal.data(), offset, bits.data()) == any && any == (offset > 0));
    for (int p = 0; p < n; ++p) CHECK((bits[p / 8] >> p % 8 & 1) == (gap[p] < 0));
  }
}
