#include "method_runs.hpp"

using namespace softffd;

TEST(eighth_order_on_the_oscillators_exact_motion) {
  CHECK_NEAR(order({}, 1, run_with<Dop853>, 40, 56), 8.0, 0.15);
  CHECK_NEAR(order({.d = 0.4}, 1, run_with<Dop853>, 40, 56), 8.0, 0.15);
  CHECK_NEAR(order({.d = 0.4, .f = 1, .g = 5}, 1, run_with<Dop853>, 40, 56), 8.0, 0.15);
}

TEST(eighth_order_while_a_frame_pulls) { check_held_order({}, 1, run_with<Dop853>, 8, 25, 35); }

TEST(eighth_order_on_a_smooth_motion) {
  for (const bool damped : {false, true})
    for (const bool ramped : {false, true}) {
      const Scene s = soft(damped, ramped);
      const char* name = damped ? ramped ? "damped and ramped" : "damped" : ramped ? "ramped" : "free";
      check_order(name, run_with<Dop853>, 8, s, reference(s), 50, 75);
    }
}

TEST(eighth_order_while_pins_move) {
  Scene s = soft(true, true);
  pin_ends(s, swinging);
  check_order("moving pins", run_with<Dop853>, 8, s, reference(s), 50, 75);
}

TEST(without_damping_it_agrees_with_a_method_of_another_family) {
  const Scene s = soft();
  CHECK_NEAR(distance(run_with<Dop853>(s, 200).state.x, run_with<Rkn12>(s, 25).state.x), 0.0, 1e-13);
}

TEST(its_error_estimate_is_of_eighth_order_and_above_the_error) {
  const Oscillator o{.d = 0.4};
  double estimates[2];
  for (int i = 0; i < 2; ++i) {
    const Scene s = scene(o, i ? 0.02 : 0.028);
    Dop853 method(8, 0);
    method.time_scale.setConstant(1 / o.omega());
    method.ledger.open({s.body, s.around}, false);
    estimates[i] = method.attempt({s.body, s.around}, 0, s.duration, s.start);
    CHECK(estimates[i] > error(o, s, run_with<Dop853>(s, 1).state));
  }
  CHECK_NEAR(std::log(estimates[0] / estimates[1]) / std::log(1.4), 8.0, 0.15);
}
