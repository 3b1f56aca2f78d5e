#include <algorithm>
#include <memory>

#include "soft_bodies.hpp"

using namespace softffd;

namespace {

/// Samples side by side on the lower face of the unit box.
std::vector<Vec3> face(int side) {
  std::vector<Vec3> places;
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) places.push_back({double(j) / (side - 1), double(i) / (side - 1), 0});
  return places;
}

/// A box of 1 kg on the ground.
SoftBody standing(const std::vector<Vec3>& places, int planes = 1) {
  Definition definition = one_kilogram({4, 4, 4}, planes);
  definition.samples = std::make_shared<Samples>(Basis::bezier, definition.lattice, places);
  SoftBody body = soft_body(definition, 1e3);
  body.settings.damping = 0.3;
  body.settings.gravity = {0, 0, -9.81};
  body.settings.step = 1e-4;
  body.settings.method = Method::leapfrog;
  for (PlaneMotion& plane : body.settings.planes) plane.friction = 0.4;
  return body;
}

Count rows(const std::vector<Count>& numbers) {
  return std::count_if(numbers.begin(), numbers.end(), [](Count number) { return number >= 0; });
}

}  // namespace

/// Which of crowded samples carry the body is not unique: were others to carry it at the end of a step than in its middle, friction on
/// these could not hold what those hold, and points would go on moving to and fro within each step.
TEST(a_crowded_face_comes_to_rest) {
  for (const int side : {21, 71}) {
    SoftBody body = standing(face(side));
    CHECK(body.initialize(0) == StepStatus::ok);
    go(body, 30, 0.1);
    CHECK(body.state().v.abs().maxCoeff() < 1e-10);
    CHECK_NEAR(body.readings().plane_reaction(0).z(), -9.81, 1e-6);
    const SurfaceRows& surface = body.run().physical.surface;
    CHECK(rows(surface.drift) >= 3);
    CHECK(surface.drift == surface.close);
  }
}

TEST(near_samples_are_looked_for_once_in_a_communication_step_in_which_nothing_moves) {
  constexpr int side = 21;
  SoftBody body = standing(face(side));
  CHECK(body.initialize(0) == StepStatus::ok);
  go(body, 30, 0.1);
  CHECK(body.advance(0.008) == StepStatus::ok);
  const double together = body.work_done(), search = Operations::of_value * side * side / Operations::in_evaluation(64);
  double apart = 0;
  for (int i = 0; i < 10; ++i) {
    CHECK(body.advance(0.0008) == StepStatus::ok);
    apart += body.work_done();
  }
  CHECK_NEAR(apart - together, 9 * search, 0.5 * search);
}

/// A plate comes down on three feet's body, leaves, and comes again: what is at hand on one plane says nothing of the other.
TEST(samples_that_come_to_another_plane_are_seen) {
  std::vector<Vec3> places{{0.2, 0.2, 0}, {0.8, 0.25, 0}, {0.5, 0.8, 0}, {0.5, 0.5, 1}, {0.4, 0.6, 0.97}};
  SoftBody body = standing(places, 2);
  body.settings.planes[1].normal = {0, 0, -1};
  body.settings.planes[1].moved_by_input = true;
  const auto plate = [](double t) { return 1.05 - 0.1 * std::sin(3 * t) * std::sin(3 * t); };
  double t = 0, pressed = 0;
  body.settings.planes[1].point = {0, 0, plate(0)};
  CHECK(body.initialize(0) == StepStatus::ok);
  const Samples samples(Basis::bezier, {}, places);
  for (int i = 0; i < 2000; ++i) {
    body.settings.planes[1].point = {0, 0, plate(t)};
    body.settings.planes[1].velocity = {0, 0, (plate(t + 1e-3) - plate(t)) / 1e-3};
    CHECK(body.advance(1e-3) == StepStatus::ok);
    t += 1e-3;
    for (int s = 0; s < samples.count(); ++s) {
      const double z = samples.at(s, body.state().x).z();
      CHECK(z >= -1e-12 && z <= plate(t) + 1e-12);
    }
    pressed = std::max(pressed, body.readings().plane_reaction(1).z());
  }
  CHECK(pressed > 1);
}

/// A conveyor belt carries what stands on it: friction holds more than the 1.92 N that damping takes.
TEST(what_stands_on_a_moving_plane_goes_with_it) {
  SoftBody body = standing(face(3));
  body.settings.planes[0].velocity = {0.1, 0, 0};
  CHECK(body.initialize(0) == StepStatus::ok);
  go(body, 40, 0.1);
  const double before = body.state().x.col(0).mean();
  CHECK(body.advance(0.1) == StepStatus::ok);
  CHECK_NEAR(body.state().x.col(0).mean() - before, 0.01, 1e-9);
  CHECK_NEAR(body.readings().plane_reaction(0).x(), -0.3 * 64 * 0.1, 1e-6);
}
