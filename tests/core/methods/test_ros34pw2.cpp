#include "ros34pw2_scenes.hpp"

using namespace softffd;

TEST(third_order_with_the_stiffness_of_each_step_while_pins_move_and_with_internal_damping) {
  check_third_order("free", soft());
  if (check::thorough) check_third_order("wide", soft(true, true, wide));
  check_third_order("wide, dashpots", with_dashpots(soft(true, true, wide), 0.01));
  check_third_order("strong dashpots", with_dashpots(soft(true, true), 0.1));
  Scene swinging = soft(true, true), turning = swinging;
  pin_ends(swinging, moving({0.3, 0.4, -0.2}, {2, -3, 1}, {0.5, -1, 2}));
  check_third_order("moving pins", swinging);
  pin_ends(turning, moving({0.3, 0.4, -0.2}, {0, 0, 0}, {0.5, -1, 2}));
  check_third_order("dashpots and pins", with_dashpots(turning, 0.01));
}

TEST(third_order_with_a_foreign_frozen_factor) {
  Scene s = soft(true, true);
  pin_ends(s, moving({0.3, 0.4, -0.2}, {2, -3, 1}));
  const Result exact = reference(s);
  Errors errors[2];
  for (int i = 0; i < 2; ++i) {
    const int steps = 160 << i;
    Ros34pw2 method(s.lattice, 2);
    const Points foreign = 0.8 * rest_positions(s.lattice) + 0.05 * s.start.v;
    const auto factor_foreign = [&] {
      method.factored.x.change() = foreign;
      method.factored.h = s.duration / steps;
      method.factored.uses = 0;
    };
    errors[i] = difference(run(method, s, steps, factor_foreign), exact);
    CHECK(method.factorizations() == 1);
  }
  check_third_order("frozen", errors[0], errors[1]);
}

TEST(the_error_estimate_is_of_third_order_and_above_the_error) {
  const Scene s = soft(true, true);
  const Equations equations{s.body, s.around};
  double estimates[2], errors[2];
  for (int i = 0; i < 2; ++i) {
    Scene step = s;
    step.duration = 0.002 / (1 << i);
    Ros34pw2 method(s.lattice, 0);
    method.time_scale = Scalars::Constant(3 * s.body.points(), 0.05);
    method.ledger.open(equations, false);
    estimates[i] = method.attempt(equations, 0, step.duration, s.start);
    const Result exact = reference(step, 20);
    errors[i] = std::max(distance(method.x, exact.state.x), 0.05 * distance(method.v, exact.state.v));
    CHECK(errors[i] < estimates[i] && errors[i] > 0);
  }
  CHECK_NEAR(std::log2(estimates[0] / estimates[1]), 3.0, 0.15);
  CHECK(std::log2(errors[0] / errors[1]) > 3.7);
}

TEST(pins_receive_to_rounding_what_the_body_loses) {
  const auto lost = [](Scene s, bool pinned = true) {
    if (pinned) pin_ends(s, moving({0.3, 0.4, -0.2}, {0, 0, 0}));
    Ros34pw2 method(s.lattice, pinned ? 2 : 0);
    return momentum_lost(s, run(method, s, 10));
  };
  for (bool damped : {false, true}) CHECK_NEAR(lost(soft(damped, true)), 0.0, 1e-13);  // momenta of 1 N s
  CHECK_NEAR(lost(soft(true, true, wide)), 0.0, 30 * ConjugateGradients::exact);       // momenta of 30 N s
  CHECK_NEAR(lost(soft(), false), 0.0, 1e-14);                                         // free
}

TEST(a_body_carried_along_steadily_feels_nothing) {
  Scene s = soft();
  const Vec3 velocity(3, -4, 5);
  s.around.force.setZero();
  pin_ends(s, moving(velocity, {0, 0, 0}));
  s.around.pins[0].velocity = velocity;
  const Points rest = rest_positions(s.lattice);
  s.start.v = velocity.transpose().array().replicate(rest.rows(), 1);
  springs_of(s.body).set_stiffness({1e9, 1e9, 1e9}, {});
  start_at(s, rest, Points(s.start.v));
  Ros34pw2 method(s.lattice, 2);
  const Result r = run(method, s, 5);
  const Points carried = rest + s.duration * s.start.v;
  CHECK_NEAR(distance(r.state.x, carried), 0.0, 1e-12);
  CHECK_NEAR(distance(r.state.v, s.start.v), 0.0, 1e-8);  // 1e9 N/m times a rounding error of 1e-16 m is 1e-7 N on 0.1 kg
}

TEST(long_steps_follow_a_stiff_body_under_a_slow_load) {
  const Scene s = stiff();
  const Result exact = reference(s, 4000);  // omega 9.3e4 rad/s: omega h = 2.3
  double before = 0;
  for (int steps : {5, 10, 20}) {
    Ros34pw2 method(s.lattice, 0);
    const double error = distance(run_fresh(method, s, steps).state.x, exact.state.x);
    CHECK(error < 1e-5);  // the load moves points by 2e-2 m
    if (before > 0) CHECK(error < before / 4);
    before = error;
  }
}

TEST(a_stiff_body_follows_an_accelerating_pin) {
  Scene s = stiff();
  s.around = no_forces(64);
  const Points rest = rest_positions(s.lattice);
  std::vector<int> points;
  for (int p = 0; p < 64; p += 4) points.push_back(p);
  s.around.pins.push_back(pin_points(s.body, rest, points, moving({0.2, 0, 0}, {10, 0, 0})));
  set_rates(s.body);
  Points v = Points::Zero(64, 3);
  v.col(0) = 0.2;
  start_at(s, rest, v);
  const Result exact = reference(s, 4000);
  for (int steps : {5, 10}) {
    Ros34pw2 method(s.lattice, 1);
    const Errors e = difference(run(method, s, steps), exact);
    CHECK(e.x < 3e-6);  // of 7e-2 m; impulse of 3.2 N s, dissipated energy of 1.8 J, work of 2.5 J
    CHECK(e.impulse < 2e-4 && e.dissipated < 1e-4 &&
          e.work < 3e-3);  // the sudden start lets the exact body ring, which long steps pass over
  }
}

TEST(a_step_keeps_of_a_vibration_what_it_says) {
  const Lattice lattice{{2, 2, 2}};
  Scene s{lattice, even_body(lattice, 0, 8), no_forces(8), {}, 0};
  springs_of(s.body).set_stiffness({1e3, 0, 0}, {});
  set_rates(s.body);
  const double omega = std::sqrt(2 * 1e3);  // of two points at the ends of a spring
  Points x = rest_positions(lattice);
  x.col(0) *= 1 + 1e-6;
  start_at(s, x, Points::Zero(8, 3));
  for (double y : {0.3, 1.0, 3.0, 10.0}) {
    s.duration = y / omega;
    Ros34pw2 method(lattice, 0);
    const State end = run(method, s, 1).state;
    const double extension = end.x(1, 0) - end.x(0, 0) - 1, speed = end.v(1, 0) - end.v(0, 0);
    const double left = std::sqrt(extension * extension + speed * speed / (omega * omega)) / 1e-6;
    CHECK_NEAR(Ros34pw2::kept(y), left, 1e-5);
  }
}

TEST(a_state_without_numbers_has_an_error_without_a_number) {
  Scene s = soft();
  s.start.x(3, 1) = std::nan("");
  s.body.internal_force(s.start.x, s.start.spring);
  Ros34pw2 method(s.lattice, 0);
  const double error = method.attempt({s.body, s.around}, 0, 0.01, s.start);
  CHECK(!(error <= 1e300));
}
