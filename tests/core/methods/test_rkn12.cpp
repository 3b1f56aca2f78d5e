#include "method_runs.hpp"

using namespace softffd;

TEST(twelfth_order_on_the_oscillators_exact_motion) {
  for (const Oscillator& o : {Oscillator{}, Oscillator{.f = 1, .g = 5}}) check_oscillator_order(o, run_with<Rkn12>, {12, 10, 14});
}

TEST(twelfth_order_while_a_frame_pulls) { check_held_order({.o = {.k = 100}}, run_with<Rkn12>, {12, 10, 14}); }
TEST(its_error_estimate_is_of_eleventh_order_and_above_the_error) { check_estimate<Rkn12>({}, 11, 0.056, 0.04); }

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
