#include "method_runs.hpp"

using namespace softffd;

TEST(fourth_order_on_the_oscillators_exact_motion) { check_oscillator_orders(run_with<Bm4>, {4, 40, 80}, false); }
TEST(fourth_order_on_a_smooth_motion) { check_smooth_orders(run_with<Bm4>, {4, 80, 160}); }
TEST(fourth_order_while_pins_move) { check_order_with_moving_pins(run_with<Bm4>, {4, 80, 160}); }
TEST(fourth_order_while_a_frame_pulls) { check_held_order({}, run_with<Bm4>, {4, 40, 80}); }

TEST(it_goes_back_the_way_it_came) {
  CHECK_NEAR(way_back(soft(), run_with<Bm4>, 20), 0.0, 1e-13);  // rounding, which the motion hardly amplifies
}

TEST(it_is_symplectic) {
  Scene s = soft();
  s.duration = 0.03;
  CHECK_NEAR(symplectic_defect(s, run_with<Bm4>), 0.0, 1e-8);
}

TEST(heavy_damping_is_its_exact_flow) {
  Oscillator o{.k = 0, .d = 40, .w0 = 3};  // d h / m = 16 a step
  Scene s = scene(o, 0.1);
  const State end = run_with<Bm4>(s, 1).state;
  const double kept = std::exp(-o.d / o.m * s.duration);
  CHECK_NEAR(end.v(1, 0), 0.5 * o.w0 * kept, 1e-15 * o.w0);
}

TEST(unwatched_steps_have_the_same_bits) { check_unwatched_steps<Bm4>(); }
