#include "falling_box.hpp"

using namespace softffd;

namespace {

/// A box with internal damping on the ground, or above it.
FallingBox damped(double k, double tau, double friction) {
  FallingBox scene(k, 1);
  springs_of(scene.body).set_dashpots(tau);
  scene.body.damped = true;
  scene.around.planes[0].friction = friction;
  return scene;
}

/// Where a box that sags on the ground and slides along it is after 0.1 s in so many steps.
Points sagged(int steps) {
  FallingBox scene = damped(2e3, 2e-3, 0.2);
  scene.throw_at({1, 0, 0}, Vec3::Zero());
  CheckedRun run(scene, 0.1 / steps, 0.1, true);
  return scene.state.x;
}

}  // namespace

TEST(sdirk2_is_of_second_order_on_a_smooth_stretch_of_contact_and_balances_momentum_and_energy) {
  const Points exact = sagged(1280);
  double before = 0;
  for (const int steps : {20, 40, 80, 160}) {
    const double error = (sagged(steps) - exact).abs().maxCoeff();
    if (before > 0) CHECK(before / error > 3.5 && before / error < 4.6);
    before = error;
  }
  CHECK(before < 1e-5);
}

TEST(sdirk2_is_exact_in_a_fall_and_in_sliding_and_keeps_rest_and_what_sticks) {
  FallingBox falling(1e6, 0);
  CheckedRun fall(falling, 0.05, 0.5, true);
  CHECK_NEAR(FallingBox::mean(falling.state.x).z(), 0.5 - 0.5 * g * 0.25, 1e-13);
  CHECK_NEAR(falling.state.x(0, 2), -0.5 * g * 0.25, 1e-11);  // it turns by what rounding leaves of a condition of 4e5

  FallingBox sliding = damped(1e8, 1e-3, 0.3);
  sliding.throw_at({2, 0, 0}, Vec3::Zero());
  CheckedRun slide(sliding, 0.01, 0.4, true);
  CHECK_NEAR(FallingBox::mean(sliding.state.v).x(), 2 - 0.3 * g * 0.4, 1e-4);
  CHECK_NEAR(slide.force(0, 0.01).z(), -g, 1e-3);
  CHECK_NEAR(slide.force(0, 0.01).x(), 0.3 * g, 1e-3);

  FallingBox sticking = damped(1e8, 1e-3, 0.4);
  sticking.incline(20);
  CheckedRun stick(sticking, 0.01, 0.5, true);
  const double there = FallingBox::mean(sticking.state.x).x();
  CHECK(stick.run(sticking, 0.01, 1));
  CHECK_NEAR(FallingBox::mean(sticking.state.x).x(), there, 1e-9);
}

TEST(what_strikes_is_not_thrown_back_by_the_second_stage) {
  for (const double h : {1e-2, 1e-3, 1e-4, 1e-5})
    for (const double gap : {0.1, 0.5, 0.9}) {  // of the way of a step
      FallingBox scene = damped(1e6, 1e-3, 0.5);
      scene.throw_at({1, 0, -2}, Vec3::Zero());
      scene.state.x.col(2) += gap * 2 * h;
      CheckedRun run(scene);
      scene.body.internal_force(scene.state.x, scene.state.spring);
      const double before = scene.energy() + g * FallingBox::mean(scene.state.x).z();
      CHECK(run.method.advance_sdirk2({scene.body, scene.around}, 0, h, {}, true, scene.state, run.exchange) == StepStatus::ok);
      CHECK(scene.energy() + g * FallingBox::mean(scene.state.x).z() <= before * (1 + 1e-12));
      CHECK(scene.least_gap(h) >= -1e-15);
    }
}
