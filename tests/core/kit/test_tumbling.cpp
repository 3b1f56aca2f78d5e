/// Growth of errors of a rigid body that turns freely.
#include "kit/tumbling.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "check.hpp"

using namespace softffd;

namespace {

using Matrix = Eigen::Matrix3d;
const Vec3 inertia(0.17, 1.01, 1.16);

/// Motion with this spin in its principal axes, which are turned by a rotation.
RigidMotion turning(const Vec3& spin, const Matrix& axes = Matrix::Identity()) {
  RigidMotion motion{};
  motion.mass = 1;
  motion.spin = axes * spin;
  motion.angular_momentum = axes * inertia.cwiseProduct(spin);
  motion.inverse_inertia = axes * inertia.cwiseInverse().asDiagonal() * axes.transpose();
  return motion;
}

}  // namespace

TEST(an_error_hardly_grows_while_a_body_turns_about_a_stable_axis) {
  CHECK(tumbling_growth(turning(Vec3(12, 0.01, 0.01)), 8).mean < 5);
  CHECK(tumbling_growth(turning(Vec3(0.01, 0.01, 12)), 8).mean < 5);
  CHECK(tumbling_growth(turning(Vec3::Zero()), 8).mean == 1);
}

TEST(an_error_grows_exponentially_while_a_body_turns_about_its_middle_axis) {
  const double spin = 10, rate = spin * std::sqrt((inertia[1] - inertia[0]) * (inertia[2] - inertia[1]) / (inertia[0] * inertia[2]));
  const auto sum = [&](double time) { return time * tumbling_growth(turning(Vec3(0, spin, 0)), time).mean; };
  CHECK_NEAR(std::log(sum(2) / sum(1)) / rate, 1, 0.01);
  CHECK(std::isfinite(sum(100)) && sum(100) > 1e15);
}

/// Times of flips are those of the same motion, also where the solver orders the axes as in a mirror.
TEST(the_growth_does_not_depend_on_the_axes_of_the_world) {
  const Vec3 spin(0.01, 12, 0.03);
  const double growth = tumbling_growth(turning(spin), 1.5).mean;
  CHECK(growth > 100);
  for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(1, 1, 1), Vec3(0.3, -0.5, 0.9)})
    for (double angle : {0.7, 1.5707963267948966, 2.0943951023931953, 3.0}) {
      const Matrix axes = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
      CHECK_NEAR(tumbling_growth(turning(spin, axes), 1.5).mean / growth, 1, 0.1);
    }
}

/// It is what nearby motions show: an error in the amplitude of the unstable motion becomes one of the time of the flip.
TEST(a_longer_run_through_a_flip_multiplies_errors_more) {
  CHECK(tumbling_growth(turning(Vec3(0.01, 12, 0.01)), 8.8).mean > 1e6);
  CHECK(tumbling_growth(turning(Vec3(4, 5, 6)), 8).mean < 20);
}
