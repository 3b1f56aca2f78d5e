#include <numbers>

#include "method_runs.hpp"

using namespace softffd;

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

constexpr Stepping carrying = [](const Scene& s, int steps) { return run_carrying(s, steps, true); };

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
double order_pressed(double friction, double time) {
  const Scene s = pressed(friction, time);
  const Points exact = run_with<Leapfrog>(s, 12800).state.x;
  return std::log2(distance(run_with<Leapfrog>(s, 200).state.x, exact) / distance(run_with<Leapfrog>(s, 800).state.x, exact)) / 2;
}

}  // namespace

TEST(second_order_in_lasting_contact) {
  for (const double friction : {0.0, 0.2})
    for (const double time : {0.0, 0.003, 0.01}) CHECK_NEAR(order_pressed(friction, time), 2.0, 0.15);
}

/// The oscillator swings with omega = 20 / s, its dashpots' rate is tau omega^2.
TEST(carried_velocities_are_stable_up_to_the_stated_step) {
  for (const double tau : {0.0, 0.002, 0.02, 0.05, 0.2}) {
    const Oscillator o{.w0 = 0, .tau = tau};
    const double omega = o.omega(), longest = std::min(2 / omega, 1 / (tau * omega * omega));
    const auto grows = [&](double h) {
      const State end = carrying(scene(o, 1000 * h), 1000).state;
      return !(std::abs(end.x(1, 0) - end.x(0, 0) - 1) < 3 * o.y0);
    };
    CHECK(!grows(0.98 * longest) && grows(1.02 * longest));
  }
}

TEST(carried_velocities_make_a_vibration_decay_at_its_rate) {
  const Oscillator o{.w0 = 0, .tau = 0.005};  // tau omega = 0.1
  const double rate = 0.5 * o.tau * o.omega() * o.omega(), h = 0.2 / o.omega();
  const double period = 2 * std::numbers::pi / std::sqrt(o.omega() * o.omega() - rate * rate);
  const State end = carrying(scene(o, 3 * period), int(std::round(3 * period / h))).state;
  CHECK_NEAR(std::log(o.y0 / (end.x(1, 0) - end.x(0, 0) - 1)) / (3 * rate * period), 1.0, 2e-3);
}

TEST(unwatched_carried_velocities_have_the_same_bits) {
  const Scene s = with_dashpots(soft(true, true), 0.003);
  const State watched = run_carrying(s, 25, true).state, unwatched = run_carrying(s, 25, false).state;
  CHECK((watched.x == unwatched.x).all() && (watched.v == unwatched.v).all() && (watched.spring == unwatched.spring).all());
}
