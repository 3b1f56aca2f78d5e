/// Calibrations: steps that the tolerance allows, found by trial.
#include "stepping/calibration.hpp"

#include <limits>

#include "bench.hpp"
#include "check.hpp"
#include "kit/limits.hpp"

using namespace softffd;

namespace {

constexpr Method fixed[] = {Method::leapfrog, Method::bm4};

double calibrated(Bench& b, Method method) {
  Calibrator(b.run).calibrate(b.integrators, b.context(), method, 0.1, 1);
  return b.run.control.calibration(method).h;
}

}  // namespace

TEST(a_trial_that_is_not_finite_shrinks_the_step) {
  for (Method method : fixed) {
    Bench b;
    b.request.tolerance = 0.1;
    const double h = step_limit(b.context(), method, false);
    CHECK(calibrated(b, method) > h);
    b.run.control.calibration(method).h = h;
    b.run.physical.motion.v(13, 1) = std::numeric_limits<double>::quiet_NaN();
    CHECK(calibrated(b, method) < 0.5 * h);
    CHECK(calibrated(b, method) < 0.05 * h);
  }
}

TEST(a_trial_that_fails_shrinks_the_step) {
  Bench b(2);  // planes that close on it
  b.request.tolerance = 1e-2;
  const double h = b.run.control.calibration(Method::leapfrog).h = step_limit(b.context(), Method::leapfrog, false);
  b.drive.planes[0] = {{.point = {0, 0, -0.01}, .velocity = {0, 0, 2 / h}}};
  b.drive.planes[1] = {{.point = {0, 0, 1.01}, .normal = -Vec3::UnitZ(), .velocity = {0, 0, -2 / h}}};
  CHECK(b.integrators.take(b.context(), Method::leapfrog, {0, 0, h, 1}).status == StepStatus::impossible_planes);
  CHECK(calibrated(b, Method::leapfrog) < 0.5 * h);
}

TEST(a_trial_that_comes_upon_an_obstacle_says_nothing) {
  Bench b(1);
  b.request.tolerance = 1e-2;
  b.drive.planes[0] = {{.point = {0, 0, 0.01}}};
  const double h = b.run.control.calibration(Method::bm4).h = step_limit(b.context(), Method::bm4, false);
  CHECK_NEAR(calibrated(b, Method::bm4), h, 0.2 * h);  // of equal parts
}
