/// What the explicit methods claim, each on the same motions: a newcomer joins the lists.
#include "method_runs.hpp"

using namespace softffd;

namespace {

constexpr Stepping leapfrog = run_with<Leapfrog>, bm4 = run_with<Bm4>, rkn12 = run_with<Rkn12>, dop853 = run_with<Dop853>;
constexpr Stepping carried = [](const Scene& s, int steps) { return run_carrying(s, steps, true); };

}  // namespace

TEST(orders_on_the_oscillators_exact_motion) {
  check_oscillator_orders(leapfrog, {2, 200, 400});
  check_oscillator_orders(bm4, {4, 40, 80}, false);
  check_oscillator_orders(dop853, {8, 40, 56});
  for (const Oscillator& o : {Oscillator{}, Oscillator{.f = 1, .g = 5}}) check_oscillator_order(o, rkn12, {12, 10, 14});
}

TEST(orders_with_internal_damping) {
  check_orders_with_dashpots(leapfrog, {2, 400, 800});
  check_orders_with_dashpots(carried, {2, 400, 800});
  check_oscillator_order({.d = 0.4, .f = 1, .g = 5, .tau = 0.02}, carried, {2, 200, 400});
  check_orders_with_dashpots(dop853, {8, 56, 80, 0.3}, 0.002);
}

TEST(error_estimates_have_their_order_and_are_above_the_error) {
  check_estimate<Dop853>({.d = 0.4}, 8, 0.028, 0.02);
  check_estimate<Rkn12>({}, 11, 0.056, 0.04);
}

TEST(leapfrog_and_bm4_are_symplectic_and_go_back_the_way_they_came) {
  for (const auto& [run, steps, h] : {std::tuple{leapfrog, 50, 0.02}, {bm4, 20, 0.03}}) {  // omega h = 0.8, 1.2
    Scene s = soft();
    CHECK_NEAR(way_back(s, run, steps), 0.0, 1e-13);  // rounding, which the motion hardly amplifies
    s.duration = h;
    CHECK_NEAR(symplectic_defect(s, run), 0.0, 1e-8);
  }
}

TEST(unwatched_steps_have_the_same_bits) {
  check_unwatched_steps<Leapfrog>();
  check_unwatched_steps<Bm4>();
}

TEST(bm4_takes_heavy_damping_as_its_exact_flow) {
  const Oscillator o{.k = 0, .d = 40, .w0 = 3};  // d h / m = 16 a step
  const Scene s = scene(o, 0.1);
  CHECK_NEAR(bm4(s, 1).state.v(1, 0), 0.5 * o.w0 * std::exp(-o.d / o.m * s.duration), 1e-15 * o.w0);
}

/// Where springs turn and frames swing the error of rkn12 is rounding before it falls by one power alone; but any wrong term would be seen.
TEST(sixteen_steps_of_a_smooth_motion_are_nearly_exact) {
  for (const bool ramped : {false, true})
    for (const bool pinned : {false, true}) {
      Scene s = soft(false, ramped);
      if (pinned) pin_ends(s, swinging);
      const Errors e = difference(rkn12(s, 16), reference(s));
      CHECK(e.x < 1e-12 && e.v < 5e-11);  // 16 steps of omega h = 1.5
      CHECK(e.impulse < 5e-12 && e.torque < 5e-12 && e.work < 2e-11);
    }
}
