#include <numbers>

#include "method_runs.hpp"

using namespace softffd;

TEST(a_vibration_has_the_frequency_of_the_central_difference) {
  const Oscillator o{.w0 = 0};
  const double h = 0.03;  // omega h = 0.6
  const Scene s = scene(o, 100 * h);
  const State end = run_with<Leapfrog>(s, 100).state;
  const double slow = 2 * std::asin(0.5 * o.omega() * h);                         // angle per step
  CHECK_NEAR(end.x(1, 0) - end.x(0, 0) - 1, o.y0 * std::cos(100 * slow), 1e-13);  // 100 steps of rounding of 1e-16
}

TEST(pins_receive_to_rounding_what_the_body_loses) {
  Scene s = soft(false, true);
  pin_ends(s, swinging);
  CHECK_NEAR(momentum_lost(s, run_with<Leapfrog>(s, 20)), 0.0, 1e-13);  // momenta of 1 N s
}

TEST(steps_in_contact_have_the_bits_of_those_that_are_watched) {  // which keep what lies between two kicks of all points
  Scene s = soft(true, false, {{4, 4, 4}});
  s.duration = 4;
  s.around.force.col(2) -= 0.1;
  s.around.planes.resize(1);
  s.around.planes[0].point.z() = -0.01;
  s.around.planes[0].friction = 0.1;
  constexpr int steps = 4000;  // of blocks that touch it is kept for 100
  Leapfrog method(s.body.points(), 1);
  const Result watched = run_method(method, s, steps), unwatched = run_method(method, s, steps, false);
  CHECK((watched.state.x == unwatched.state.x).all() && (watched.state.v == unwatched.state.v).all());
  const Count least = 5 * steps, most = 13 * steps;  // of 16 points some come and go
  CHECK(watched.exchange.contacts_resolved > least && watched.exchange.contacts_resolved < most);
}

namespace {

Stepping stepping(Dashpots kind) {
  if (kind == Dashpots::carried) return [](const Scene& s, int steps) { return run_carrying(s, steps, true); };
  return [](const Scene& s, int steps) { return run_anew(s, steps, true); };
}

/// On a plane from the beginning, pressed so that the lower layer stays there, while it slides and the upper one swings.
Scene pressed(double friction, double time) {
  Scene s = with_dashpots(soft(true, true), time);
  Points x = rest_positions(s.lattice), v = s.start.v;
  for (int p = 0; p < s.body.points(); ++p)
    if (x(p, 2) == 0) s.around.force(p, 2) = -8, v(p, 2) = 0, v(p, 0) += 5;
  s.around.planes.resize(1);
  s.around.planes[0].friction = friction;
  start_at(s, x, v);
  return s;
}

/// Slope of the error over two halvings of the step, against many steps.
double order_pressed(double friction, double time, Stepping run = run_with<Leapfrog>) {
  const Scene s = pressed(friction, time);
  const Points exact = run_with<Leapfrog>(s, 12800).state.x;
  return std::log2(distance(run(s, 200).state.x, exact) / distance(run(s, 800).state.x, exact)) / 2;
}

}  // namespace

TEST(second_order_in_lasting_contact) {
  for (const double friction : {0.0, 0.2})
    for (const double time : {0.0, 0.003, 0.01}) CHECK_NEAR(order_pressed(friction, time), 2.0, 0.15);
  for (const Dashpots kind : {Dashpots::carried, Dashpots::anew})
    for (const double friction : {0.0, 0.2}) CHECK_NEAR(order_pressed(friction, 0.003, stepping(kind)), 2.0, 0.15);
}

TEST(pins_receive_to_rounding_what_a_body_with_dashpots_loses) {
  Scene s = soft(false, true);
  pin_ends(s, swinging);
  s = with_dashpots(s, 0.003);
  for (const Dashpots kind : {Dashpots::carried, Dashpots::anew}) CHECK_NEAR(momentum_lost(s, stepping(kind)(s, 20)), 0.0, 1e-13);
}

/// The oscillator swings with omega = 20 / s, its dashpots' rate is tau omega^2. A plane that it does not come to makes the limits those
/// of contact.
TEST(steps_with_dashpots_are_stable_up_to_the_stated_length) {
  const auto grows = [](Dashpots kind, const Oscillator& o, double h) {
    Scene s = scene(o, 1000 * h);
    s.around.planes.resize(1);
    s.around.planes[0].point.z() = -9;
    const State end = stepping(kind)(s, 1000).state;
    return !(std::abs(end.x(1, 0) - end.x(0, 0) - 1) < 2 * o.y0);
  };
  for (const double tau : {0.0, 0.002, 0.02, 0.2}) {
    const Oscillator o{.w0 = 0, .tau = tau};
    const double omega = o.omega(), rate = tau * omega * omega, carried = 2 / (rate + std::sqrt(rate * rate + omega * omega));
    CHECK(!grows(Dashpots::carried, o, 0.98 * carried) && grows(Dashpots::carried, o, 1.02 * carried));
    double anew = 1 / omega;  // (omega h / 2)^2 = 1 - rate h / 2 + (rate h)^2 / 4, or rate h = 2, is the first to come
    const auto left = [&](double h) { return 1 - rate * h / 2 + rate * rate * h * h / 4 - omega * omega * h * h / 4; };
    for (double low = 0, high = 2 / std::max(rate, omega); high - low > 1e-9 * high;)
      anew = 0.5 * (low + high), (left(anew) > 0 ? low : high) = anew;
    CHECK(!grows(Dashpots::anew, o, 0.98 * anew) && grows(Dashpots::anew, o, 1.02 * anew));
  }
}

TEST(dashpots_make_a_vibration_decay_at_their_rate) {  // by solving too: the others err by a 25th to a 500th of (omega h)^2 of it
  const Oscillator o{.w0 = 0, .tau = 0.005};           // tau omega = 0.1
  const double rate = 0.5 * o.tau * o.omega() * o.omega(), h = 0.2 / o.omega(), turn = 2 * std::numbers::pi / o.omega();
  const double period = turn / std::sqrt(1 - power(0.5 * o.tau * o.omega(), 2));
  for (const Dashpots kind : {Dashpots::carried, Dashpots::anew}) {
    const State end = stepping(kind)(scene(o, 3 * period), int(std::round(3 * period / h))).state;
    CHECK_NEAR(std::log(o.y0 / (end.x(1, 0) - end.x(0, 0) - 1)) / (3 * rate * period), 1.0, 2e-3);
  }
}

TEST(dashpots_leave_a_pressed_body_at_rest) {
  Scene s = with_dashpots(soft(false, false, {{2, 2, 2}}), 0.01);
  const Points x = rest_positions(s.lattice);
  s.around.force.setZero();
  s.around.planes.resize(1);
  for (int p = 0; p < 8; ++p)
    if (x(p, 2) == 0) s.around.force(p, 2) = -5;
  start_at(s, x, Points::Zero(8, 3));
  for (const Dashpots kind : {Dashpots::carried, Dashpots::anew}) {
    const Result end = stepping(kind)(s, 100);
    CHECK_NEAR(distance(end.state.x, x), 0.0, 1e-14);
    CHECK_NEAR(end.state.v.abs().maxCoeff(), 0.0, 1e-14);
  }
}

TEST(unwatched_steps_with_dashpots_have_the_same_bits) {
  const Scene s = with_dashpots(soft(true, true), 0.003);
  for (const auto& run : {run_carrying, run_anew}) {
    const State watched = run(s, 25, true).state, unwatched = run(s, 25, false).state;
    CHECK((watched.x == unwatched.x).all() && (watched.v == unwatched.v).all() && (watched.spring == unwatched.spring).all());
  }
}
