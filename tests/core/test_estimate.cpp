#include "estimate.hpp"

#include <cstdio>

#include "check.hpp"

using namespace softffd;

TEST(the_second_run_of_a_stiff_body_that_flies_near_an_obstacle_takes_long_steps_too) {
  Definition definition;
  definition.mass.assign(64, 1.0 / 64);
  definition.planes = 1;
  definition.offset = {0, 0, 0.01};
  definition.velocity = {2, 0, 0};
  definition.angular_velocity = {0, 0, 3};
  SoftBody body(definition);
  ErrorEstimate estimate(definition);
  body.settings.stiffness = {1e9, 1e9, 1e9};
  body.initialize(0);
  estimate.initialize(body, 0);
  for (int n = 0; n < 10; ++n) {
    CHECK(body.advance(0.01) == StepStatus::ok);
    estimate.follow(body, 0.01);
  }
  const Course run = body.run().course, second = estimate.memory().shadow.course;
  CHECK(run.method == Method::floating_frame);
  CHECK(second.method == Method::floating_frame);
  std::printf("  work %g, second %g\n", run.work, second.work);
  CHECK(second.work <= 4 * run.work);  // twice the steps, each with a matrix of its own; explicit steps: a hundred times
}
