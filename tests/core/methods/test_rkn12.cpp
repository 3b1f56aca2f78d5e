#include "method_runs.hpp"

using namespace softffd;

TEST(twelfth_order_on_the_oscillators_exact_motion) {
  CHECK_NEAR(order({}, 1, run_with<Rkn12>, 10, 14), 12.0, 0.15);
  CHECK_NEAR(order({.f = 1, .g = 5}, 1, run_with<Rkn12>, 10, 14), 12.0, 0.15);
}

TEST(twelfth_order_while_a_frame_pulls) { check_held_order({.o = {.k = 100}}, 1, run_with<Rkn12>, 12, 10, 14); }

/// Where springs turn and frames swing the error is rounding before it falls by one power alone; but any wrong term would be seen.
TEST(sixteen_steps_of_a_smooth_motion_are_nearly_exact) {
  for (const bool ramped : {false, true})
    for (const bool pinned : {false, true}) {
      Scene s = soft(false, ramped);
      if (pinned) pin_ends(s, swinging);
      const Errors e = difference(run_with<Rkn12>(s, 16), reference(s));
      std::printf("  x %.1e v %.1e impulse %.1e torque %.1e work %.1e\n", e.x, e.v, e.impulse, e.torque, e.work);
      CHECK(e.x < 1e-12 && e.v < 5e-11);  // 16 steps of omega h = 1.5
      CHECK(e.impulse < 5e-12 && e.torque < 5e-12 && e.work < 2e-11);
    }
}

TEST(its_error_estimate_is_of_eleventh_order_and_above_the_error) {
  const Oscillator o;
  double estimates[2];
  for (int i = 0; i < 2; ++i) {
    const Scene s = scene(o, i ? 0.04 : 0.056);
    Rkn12 method(8, 0);
    method.time_scale.setConstant(1 / o.omega());
    method.ledger.open({s.body, s.around}, false);
    estimates[i] = method.attempt({s.body, s.around}, 0, s.duration, s.start);
    CHECK(estimates[i] > error(o, s, run_with<Rkn12>(s, 1).state));
  }
  CHECK_NEAR(std::log(estimates[0] / estimates[1]) / std::log(1.4), 11.0, 0.15);
}
