#include <array>

#include "soft_bodies.hpp"

using namespace softffd;

namespace {

SoftBody box(int planes, Vec3 offset, Vec3 velocity, double k = 0) {
  Definition definition = one_kilogram({2, 2, 2}, planes);
  definition.offset = offset;
  definition.velocity = velocity;
  return soft_body(definition, k);
}

double lowest_gap(const SoftBody& body, const Vec3& point, const Vec3& normal) {
  double gap = 1e300;
  for (int p = 0; p < 8; ++p) gap = std::min(gap, normal.normalized().dot(row(body.state().x, p) - point));
  return gap;
}

}  // namespace

TEST(a_point_stops_on_the_plane_and_stays) {
  SoftBody body = box(1, {0, 0, 0.1}, {0, 0, -1});
  body.settings.gravity = {0, 0, -9.81};
  CHECK(body.initialize(0) == StepStatus::ok);
  for (int i = 0; i < 50; ++i) {
    CHECK(body.advance(0.01) == StepStatus::ok);
    CHECK(body.state().x(0, 2) >= 0);
  }
  CHECK(body.state().x(0, 2) == 0 && body.state().v(0, 2) == 0);
  CHECK_NEAR(body.readings().plane_reaction(0).z(), -9.81, 1e-12);
}

TEST(momentum_of_an_impact_goes_to_the_plane_exactly) {
  SoftBody body = box(1, {0, 0, 0.005}, {0, 0, -1});
  body.initialize(0);
  CHECK(body.advance(0.01) == StepStatus::ok);
  CHECK_NEAR(body.readings().plane_reaction(0).z() * 0.01, -0.5, 1e-15);  // the four lower points of 1 kg in all
}

TEST(a_fast_plane_does_not_tunnel) {
  SoftBody body = box(1, {0, 0, 0}, {0, 0, 0});
  body.settings.planes[0] = {{0, 0, -5}, {0, 0, 1}, {0, 0, 1000}, {0, 0, 0}, 0, false};
  body.initialize(0);
  CHECK(body.advance(0.1) == StepStatus::ok);
  CHECK(lowest_gap(body, {0, 0, 95}, {0, 0, 1}) >= 0);
  CHECK_NEAR(body.state().v(0, 2), 1000.0, 1e-9);
}

TEST(a_closing_gap_without_room_is_an_error_and_leaves_the_state) {
  SoftBody body = box(2, {0, 0, 0}, {0, 0, 0});
  body.settings.planes[0] = {{0, 0, -0.1}, {0, 0, 1}, {0, 0, 20}, {0, 0, 0}, 0, false};
  body.settings.planes[1] = {{0, 0, 1.1}, {0, 0, -1}, {0, 0, -20}, {0, 0, 0}, 0, false};
  body.initialize(0);
  const Points before = body.state().x;
  CHECK(body.advance(0.1) == StepStatus::impossible_planes);
  CHECK((body.state().x == before).all());
  CHECK(body.advance(0.01) == StepStatus::ok);
}

TEST(three_planes_catch_a_point_in_their_corner) {
  SoftBody body = box(3, {0.1, 0.1, 0.1}, {-1, -2, -3});
  body.settings.planes[0] = {{0, 0, 0}, {1, 0, 0}, {0, 0, 0}, {0, 0, 0}, 0.3, false};
  body.settings.planes[1] = {{0, 0, 0}, {0, 1, 0}, {0, 0, 0}, {0, 0, 0}, 0.3, false};
  body.settings.planes[2] = {{0, 0, 0}, {1, 1, 5}, {0, 0, 0}, {0, 0, 0}, 0.3, false};
  body.settings.gravity = {0, 0, -9.81};
  body.settings.stiffness = {1e3, 1e3, 1e3};
  body.initialize(0);
  for (int i = 0; i < 200; ++i) {
    CHECK(body.advance(0.01) == StepStatus::ok);
    for (const auto& plane : body.settings.planes) CHECK(lowest_gap(body, plane.point, plane.normal) >= -1e-15);
  }
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
