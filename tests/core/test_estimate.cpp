#include "estimate.hpp"

#include "soft_bodies.hpp"

using namespace softffd;

TEST(the_second_run_of_a_stiff_body_that_flies_near_an_obstacle_takes_long_steps_too) {
  Definition definition = one_kilogram({4, 4, 4}, 1);
  definition.offset = {0, 0, 0.01};
  definition.velocity = {2, 0, 0};
  definition.angular_velocity = {0, 0, 3};
  SoftBody body = soft_body(definition, 1e9);
  ErrorEstimate estimate(definition);
  body.initialize(0);
  estimate.initialize(body, 0);
  for (int n = 0; n < 10; ++n) {
    CHECK(body.advance(0.01) == StepStatus::ok);
    estimate.follow(body, 0.01);
  }
  const ControllerState run = body.run().control, second = estimate.memory().shadow.control;
  CHECK(run.method == Method::floating_frame);
  CHECK(second.method == Method::floating_frame);
  CHECK(second.work <= 4 * run.work);  // twice the steps, each with a matrix of its own; explicit steps: a hundred times
}

/// The order of dop853 is 8, and the second run takes two thirds of its steps.
TEST(steps_that_follow_the_tolerance_err_by_what_two_runs_differ_by_over_one_less_the_ratio_to_the_order) {
  Definition definition = one_kilogram();
  definition.stretch = {1.1, 1, 1};
  SoftBody body = soft_body(definition, 100), exact = soft_body(definition, 100);
  ErrorEstimate estimate(definition);
  body.settings.method = Method::dop853;
  exact.settings.method = Method::rkn12;
  body.settings.tolerance = 1e-5;
  exact.settings.tolerance = 1e-13;
  CHECK(body.initialize(0) == StepStatus::ok && exact.initialize(0) == StepStatus::ok);
  estimate.initialize(body, 0);
  for (int n = 0; n < 5; ++n) {
    CHECK(body.advance(0.2) == StepStatus::ok && exact.advance(0.2) == StepStatus::ok);
    estimate.follow(body, 0.2);
    const Points &x = body.state().x, &second = estimate.memory().shadow.physical.motion.x;
    CHECK_NEAR(estimate.value() * (1 - std::pow(2.0 / 3, 8)) / (x - second).abs().maxCoeff(), 1, 1e-9);
    CHECK_NEAR(estimate.value() / (x - exact.state().x).abs().maxCoeff(), 1, 0.05);
  }
}
