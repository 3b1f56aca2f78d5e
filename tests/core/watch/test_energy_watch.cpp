#include "watch/energy_watch.hpp"

#include <functional>
#include <limits>

#include "method_runs.hpp"

using namespace softffd;

namespace {

double energy(const Scene& s) { return conserved(s, s.start).energy; }

/// A motion that is watched from here on.
struct Watched {
  Scene s;
  EnergyAccount account;
  double given = 0;  ///< by the outside, all that it gave and took [J]

  explicit Watched(const Oscillator& o, double h = 1) : s(scene(o, h)) { start(account, {s.body, s.around}, s.start, 0); }
  void look(double h = 0) { softffd::look(account, {s.body, s.around}, s.start, h, 0); }
  /// With velocities that are so many times what they were.
  void look_at(double factor) {
    s.start.v *= factor;
    look();
  }
  /// A leapfrog step and the work of the outside forces in it, then what happens, then a look.
  void step(const std::function<void()>& happens = [] {}) {
    const Points before = s.start.x;
    s.start = run_with<Leapfrog>(s, 1).state;
    const double work = (s.around.force * (s.start.x - before)).sum();
    account.received += work;
    given += std::abs(work);
    happens();
    look(s.duration);
  }
};

const Oscillator moving_only{.y0 = 0, .w0 = 1};

}  // namespace

TEST(a_vibration_at_nearly_the_largest_stable_step_gains_nothing) {
  const Oscillator o;
  Watched w(o, 1.9 / o.omega());
  const double begin = energy(w.s);
  double least = 1e300, most = 0;
  for (int i = 0; i < 1000; ++i) w.step([&] { least = std::min(least, energy(w.s)), most = std::max(most, energy(w.s)); });
  CHECK(most > 5 * least);                   // what a look at kinetic and elastic energy alone would see
  CHECK(w.account.gained <= 1e-11 * begin);  // 1000 steps of rounding
  CHECK_NEAR(w.account.balance, 0.0, 1e-11 * begin);
  CHECK(!alarm(w.account, 0));
}

TEST(energy_out_of_nothing_is_seen_to_the_joule) {
  const Oscillator o;
  Watched w(o, 0.1 / o.omega());
  const double begin = energy(w.s);
  double given = 0;
  for (int i = 0; i < 100; ++i)
    w.step([&] {
      if (i != 50) return;
      given = -energy(w.s);
      w.s.start.v *= 1.2;
      given += energy(w.s);
    });
  CHECK(given > 0.01 * begin);
  CHECK_NEAR(w.account.gained, given, 1e-11 * begin);
}

TEST(it_alarms_from_a_twentieth_of_the_energy_on) {
  for (const double factor : {1.02, 1.03}) {  // 4 and 6 per cent of the kinetic energy
    Watched w(moving_only);
    w.look_at(factor);
    CHECK(alarm(w.account, 0) == (factor > 1.025));
    CHECK(!alarm(w.account, energy(w.s)));  // rounding of that size is no gain
  }
}

TEST(what_a_body_had_long_ago_hides_no_gain_and_losses_hide_none) {
  for (const Count looks : {Count{1}, 3 * late_looks}) {
    Watched w(moving_only);
    w.s.start.v *= 0.1;  // a hundredth of the energy is left
    for (Count i = 0; i < looks; ++i) w.look();
    w.look_at(1.5);
    CHECK(alarm(w.account, 0) == (looks > 1));
  }
  Watched w(moving_only);
  const double full = energy(w.s);
  for (const double factor : {0.5, 1.5}) w.look_at(factor);
  CHECK_NEAR(w.account.gained, (0.5625 - 0.25) * full, 1e-15);
  CHECK_NEAR(w.account.balance, (0.5625 - 1) * full, 1e-15);
}

TEST(what_the_outside_gives_is_no_gain_and_neither_is_a_jump_of_its_forces) {
  Watched steady({.f = 3}, 1e-3);
  for (int i = 0; i < 300; ++i) steady.step();
  CHECK(steady.given > 1);
  CHECK(steady.account.gained < 1e-4 * steady.given);  // leapfrog keeps the energy of forces to (omega h)^2

  const Oscillator o;
  Watched jumping(o, 1.5 / o.omega());
  const Points none = jumping.s.around.force, pull = scene({.f = 40}, 1).around.force;
  for (int i = 0; i < 200; ++i) {
    const Points& now = i / 7 % 2 ? pull : none;
    if (!(now == jumping.s.around.force).all()) jolt(jumping.account, jumping.s.body, jumping.s.start.spring, jumping.s.around.force, now);
    jumping.s.around.force = now;
    jumping.step();
  }
  CHECK_NEAR(jumping.account.gained, 0.0, 1e-11 * jumping.given);  // rounding: leapfrog keeps this energy exactly
}

TEST(an_account_that_is_no_number_is_an_alarm) {
  Watched w(moving_only);
  w.account.received = std::numeric_limits<double>::quiet_NaN();
  w.look();
  CHECK(alarm(w.account, 1));
}
