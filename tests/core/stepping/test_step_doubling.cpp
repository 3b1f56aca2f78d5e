/// Stretches that are run twice, on a lattice that vibrates: what the two runs differ by decides.
#include "stepping/step_doubling.hpp"

#include <cmath>
#include <limits>

#include "bench.hpp"
#include "check.hpp"
#include "kit/limits.hpp"
#include "kit/thresholds.hpp"

using namespace softffd;

namespace {

constexpr Count steps = thresholds::stretch_steps;

/// The run after so many steps of leapfrog.
State after(double h, Count n) {
  Bench b;
  b.integrators.take(b.context(), Method::leapfrog, {0, 0, h, n});
  return b.run.physical.motion;
}

}  // namespace

TEST(a_stretch_whose_two_runs_differ_by_too_much_is_run_again_with_smaller_steps) {
  Bench b;
  const double h = 0.5 * step_limit(b.context(), Method::leapfrog, false), stretch = double(steps) * h;
  const double error = growing(b.context(), after(h, steps), after(h / 2, 2 * steps), stretch) / 3;  // of the finer run: order 2
  for (double ratio : {0.5, 2.0, 8.0, 30.0}) {
    Bench each(1);
    each.request.tolerance = error / (ratio * thresholds::forecast_tolerance);
    each.run.control.contact.h = h;
    StepDoubling doubled(each.run);
    CHECK(doubled.run(each.integrators, each.context(), stretch) == StepStatus::ok);
    const bool again = ratio > thresholds::too_much;
    CHECK((each.run.control.rejected > 0) == again);
    CHECK((each.run.physical.clock.h < 0.4999 * h) == again);
    CHECK((each.run.physical.steps > 2 * steps) == again);
  }
}

TEST(what_a_stretch_errs_by_is_counted) {
  Bench b(1);
  const double h = 0.5 * step_limit(b.context(), Method::leapfrog, false), stretch = double(steps) * h;
  b.request.tolerance = 1;
  b.run.control.contact.h = h;
  StepDoubling doubled(b.run);
  CHECK(doubled.run(b.integrators, b.context(), stretch) == StepStatus::ok);
  Bench exact;
  exact.integrators.take(exact.context(), Method::leapfrog, {0, 0, h / 256, 256 * steps});
  const double error = (b.run.physical.motion.x - exact.run.physical.motion.x).abs().maxCoeff();
  CHECK(b.run.physical.steps == 2 * steps);
  CHECK(error > 0 && std::abs(b.run.physical.error.largest() / error - 1) < 0.3);
}

TEST(a_stretch_that_is_run_once_counts_as_the_coarser_run_before) {
  Bench b(1);
  const double limit = step_limit(b.context(), Method::leapfrog, false);
  b.request.tolerance = 1;
  StepDoubling doubled(b.run);
  CHECK(doubled.run(b.integrators, b.context(), double(steps) * limit) == StepStatus::ok);
  const double once = b.run.physical.error.size;
  const Count taken = b.run.physical.steps;
  CHECK(once > 0 && b.run.control.contact.free > 0);
  CHECK(doubled.run(b.integrators, b.context(), double(2 * steps) * limit) == StepStatus::ok);
  CHECK(b.run.physical.steps - taken == steps);
  CHECK_NEAR(b.run.physical.error.size, std::sqrt(17) * once, 1e-12);
}

TEST(a_stretch_without_a_finite_result_is_none) {
  Bench b(1);
  b.run.physical.motion.v(13, 1) = std::numeric_limits<double>::quiet_NaN();
  StepDoubling doubled(b.run);
  CHECK(doubled.run(b.integrators, b.context(), 0.1) == StepStatus::not_finite);
}

TEST(the_error_of_a_stretch_is_that_of_its_finer_run) {
  Bench b;
  const double h = 0.5 * step_limit(b.context(), Method::leapfrog, false), stretch = double(steps) * h;
  const State coarse = after(h, steps), fine = after(h / 2, 2 * steps), exact = after(h / 16, 16 * steps);
  CHECK_NEAR(growing(b.context(), coarse, fine, stretch) / 3 / growing(b.context(), fine, exact, stretch), 1, 0.15);
}
