/// Stretches that are run twice, on a lattice that vibrates: what the two runs differ by decides.
#include "stepping/doubled_steps.hpp"

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
  b.integrators.take(b.job(), Method::leapfrog, {0, 0, h, n});
  return b.run.path.motion;
}

}  // namespace

TEST(a_stretch_whose_two_runs_differ_by_too_much_is_run_again_with_smaller_steps) {
  Bench b;
  const double h = 0.5 * step_limit(b.job(), Method::leapfrog, false), stretch = double(steps) * h;
  const double error = growing(b.job(), after(h, steps), after(h / 2, 2 * steps), stretch) / 3;  // of the finer run: order 2
  for (double ratio : {0.5, 2.0, 8.0, 30.0}) {
    Bench each;
    each.request.tolerance = error / (ratio * thresholds::forecast_tolerance);
    each.run.course.contact.h = h;
    DoubledSteps doubled(each.run);
    CHECK(doubled.run(each.integrators, each.job(), stretch) == StepStatus::ok);
    const bool again = ratio > thresholds::too_much;
    CHECK((each.run.course.rejected > 0) == again);
    CHECK((each.run.path.clock.h < 0.4999 * h) == again);
    CHECK((each.run.path.steps > 2 * steps) == again);
  }
}

TEST(an_error_that_is_given_up_is_counted) {
  for (const bool keeps : {true, false}) {
    Bench b;
    b.request.horizon = 1e-9;  // nothing grows: what is left over is that of the stretch
    const double h = 0.5 * step_limit(b.job(), Method::leapfrog, false), stretch = double(steps) * h;
    b.request.tolerance = keeps ? 1 : 1e-30;
    b.run.course.contact.h = h;
    DoubledSteps doubled(b.run);
    CHECK(doubled.run(b.integrators, b.job(), stretch) == StepStatus::ok);
    const double given_up = b.run.course.given_up;
    CHECK((given_up > 0) == !keeps);
    if (keeps) continue;
    Bench exact;
    exact.integrators.take(exact.job(), Method::leapfrog, {0, 0, h / 2048, 2048 * steps});
    const State& reached = b.run.path.motion;
    CHECK(given_up > growing(b.job(), reached, exact.run.path.motion, stretch));
    CHECK(given_up < 1e-3 * (reached.x - Bench().run.path.motion.x).abs().maxCoeff());
  }
}

TEST(a_difference_of_a_free_bodys_speed_lasts_until_damping_forgets) {
  Bench b;
  b.request.horizon = 3;
  State faster = b.run.path.motion;
  faster.v.col(1) += 0.01;
  CHECK_NEAR(lasting(b.job(), b.run.path.motion, faster), 0.03, 1e-14);
  State further = b.run.path.motion;
  further.x(5, 0) += 1e-3;
  CHECK_NEAR(lasting(b.job(), b.run.path.motion, further), 1e-3, 1e-14);
}

TEST(a_stretch_without_a_finite_result_is_none) {
  Bench b;
  b.run.path.motion.v(13, 1) = std::numeric_limits<double>::quiet_NaN();
  DoubledSteps doubled(b.run);
  CHECK(doubled.run(b.integrators, b.job(), 0.1) == StepStatus::not_finite);
}

TEST(the_error_of_a_stretch_is_that_of_its_finer_run) {
  Bench b;
  const double h = 0.5 * step_limit(b.job(), Method::leapfrog, false), stretch = double(steps) * h;
  const State coarse = after(h, steps), fine = after(h / 2, 2 * steps), exact = after(h / 16, 16 * steps);
  CHECK_NEAR(growing(b.job(), coarse, fine, stretch) / 3 / growing(b.job(), fine, exact, stretch), 1, 0.15);
}
