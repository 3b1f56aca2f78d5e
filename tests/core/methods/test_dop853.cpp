#include "method_runs.hpp"

using namespace softffd;

TEST(eighth_order_on_the_oscillators_exact_motion) { check_oscillator_orders(run_with<Dop853>, {8, 40, 56}); }
TEST(eighth_order_on_a_smooth_motion) { check_smooth_orders(run_with<Dop853>, {8, 50, 75}); }
TEST(eighth_order_while_pins_move) { check_order_with_moving_pins(run_with<Dop853>, {8, 50, 75}); }
TEST(eighth_order_with_internal_damping) { check_orders_with_dashpots(run_with<Dop853>, {8, 56, 80, 0.3}, 0.002); }
TEST(eighth_order_while_a_frame_pulls) { check_held_order({}, run_with<Dop853>, {8, 25, 35}); }
TEST(its_error_estimate_is_of_eighth_order_and_above_the_error) { check_estimate<Dop853>({.d = 0.4}, 8, 0.028, 0.02); }

TEST(without_damping_it_agrees_with_a_method_of_another_family) {
  const Scene s = soft();
  CHECK_NEAR(distance(run_with<Dop853>(s, 200).state.x, run_with<Rkn12>(s, 25).state.x), 0.0, 1e-13);
}
