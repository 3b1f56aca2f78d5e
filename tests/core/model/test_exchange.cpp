#include "model/exchange.hpp"

#include "check.hpp"

using namespace softffd;

TEST(where_nothing_presses_the_centre_is_the_point_of_the_plane) {
  const Vec3 normal = Vec3(0.2, -0.3, 1).normalized(), point(3, -2, 0.5), place = normal.unitOrthogonal();
  const HalfSpace plane{point, normal, normal.dot(point), Vec3::Zero(), Vec3::Zero()};
  Impulse none, pulls, least;
  pulls.add(normal, place);
  least.add(-5e-324 * Vec3::UnitZ(), place);
  least.torque = Vec3(1, 2, 3);
  for (const Impulse& on : {none, pulls, least}) CHECK(centre_of_pressure(plane, on) == plane.point);
}
