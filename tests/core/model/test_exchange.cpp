#include "model/exchange.hpp"

#include "check.hpp"

using namespace softffd;

namespace {

const Vec3 normal = Vec3(0.2, -0.3, 1).normalized();

HalfSpace plane_at(const Vec3& point) { return {point, normal, normal.dot(point), Vec3::Zero(), Vec3::Zero()}; }

/// A point of the plane, this far from its point.
Vec3 along(double a, double b) {
  const Vec3 first = normal.unitOrthogonal();
  return a * first + b * normal.cross(first);
}

}  // namespace

TEST(the_centre_of_pressure_is_the_mean_of_the_points_weighted_by_how_much_each_presses) {
  const HalfSpace plane = plane_at({3, -2, 0.5});
  Impulse on;
  on.add(-2 * normal, along(0.3, 0.1));
  on.add(-6 * normal, along(-0.5, 0.9));
  const Vec3 centre = centre_of_pressure(plane, on);
  CHECK_NEAR((centre - plane.point - along(-0.3, 0.7)).norm(), 0.0, 1e-15);
  on.add(along(1.1, -0.4), along(0.3, 0.1));  // friction along the plane
  CHECK_NEAR((centre_of_pressure(plane, on) - centre).norm(), 0.0, 1e-15);
  CHECK_NEAR(normal.cross(on.torque - (centre - plane.point).cross(on.force)).norm(), 0.0, 1e-14);  // of torques of 8 N m s
}

TEST(where_nothing_presses_the_centre_is_the_point_of_the_plane) {
  const HalfSpace plane = plane_at({3, -2, 0.5});
  Impulse none, pulls, least;
  pulls.add(normal, along(1, 2));
  least.add(-5e-324 * Vec3::UnitZ(), along(1, 2));
  least.torque = Vec3(1, 2, 3);
  for (const Impulse& on : {none, pulls, least}) CHECK(centre_of_pressure(plane, on) == plane.point);
}

TEST(the_centre_on_a_solid_is_the_mean_of_the_places_weighted_by_how_much_each_presses) {
  const HalfSpace pose = plane_at({3, -2, 0.5});
  Impulse on, more;
  CHECK(centre_of_places(pose, on) == pose.point);
  on.press(2, {0.4, 0, 0.1});
  more.press(6, {0, 0.8, 0.1});
  on += more;
  CHECK_NEAR((centre_of_places(pose, on) - pose.point - Vec3(0.1, 0.6, 0.1)).norm(), 0.0, 1e-15);
}
