/// What landings make of errors, on bodies that bounce.
#include "kit/landings.hpp"

#include "surface_bodies.hpp"

using namespace softffd;

namespace {

SoftBody after(SoftBody body, double tolerance, double step, int calls) {
  body.settings.horizon = 0.01 * calls;
  body.settings.tolerance = tolerance;
  body.settings.step = step;
  CHECK(body.initialize(0) == StepStatus::ok);
  go(body, calls, 0.01);
  return body;
}

SoftBody thrown(const Vec3& stretch) {
  const Sphere sphere{.height = 0.05, .damping = 0, .velocity = {0.3, 0, -1}};
  Definition definition = sphere.definition();
  definition.stretch = stretch;
  return sphere.body(definition);
}

}  // namespace

TEST(a_body_that_does_not_vibrate_lands_later_or_earlier_and_no_error_grows_of_that) {
  const SoftBody fine = after(thrown({1, 1, 1}), 1e-3, 2e-6, 20);
  for (const double tolerance : {1e-3, 3e-4, 1e-4, 3e-5}) {
    const SoftBody body = after(thrown({1, 1, 1}), tolerance, 0, 20);
    const double error = distance(body.state().x, fine.state().x);
    CHECK(body.run().control.neighbour.impact > 0);
    CHECK(error < tolerance && error < body.readings().stated_error());
    CHECK(body.readings().landing_error() < 2 * tolerance);  // which no warning tells
  }
}

TEST(bounces_state_what_they_err_by) {
  for (const double tolerance : {1e-3, 1e-4}) {
    const SoftBody fine = after(thrown({1.02, 1, 1}), tolerance, 1e-5, 80), body = after(thrown({1.02, 1, 1}), tolerance, 0, 80);
    const double error = (fine.state().x - body.state().x).abs().maxCoeff(), stated = body.readings().stated_error();
    CHECK(body.run().control.neighbour.impact > 0.2);
    CHECK(error < 5 * stated);
    CHECK(stated < 10 * std::max(error, tolerance));
  }
}

TEST(the_neighbour_goes_on_from_a_stored_state) {
  SoftBody body = after(thrown({1.02, 1, 1}), 1e-3, 0, 3);
  while (!body.run().control.neighbour.follows && body.state().time < 0.8) go(body, 1, 0.01);
  CHECK(body.run().control.neighbour.follows);
  const Run stored = body.run();
  std::vector<double> stated;
  for (int i = 0; i < 2; ++i) {
    body.restore(stored, 0);
    go(body, 20, 0.01);
    stated.push_back(body.readings().stated_error());
  }
  CHECK(stated[0] > 0 && stated[0] == stated[1]);
}

TEST(a_new_start_states_nothing) {
  SoftBody body = after(thrown({1.02, 1, 1}), 1e-3, 0, 20);
  CHECK(body.readings().stated_error() > 0);
  CHECK(body.initialize(0) == StepStatus::ok);
  CHECK(body.readings().stated_error() == 0);
}
