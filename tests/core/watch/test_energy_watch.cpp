#include "watch/energy_watch.hpp"

#include <limits>

#include "method_runs.hpp"

using namespace softffd;

namespace {

double energy(const Scene& s) { return conserved(s, s.start).energy; }

/// One leapfrog step at a time, with a look after each.
template <class Each>
EnergyAccount watched_run(Scene s, double h, int steps, Each each) {
  EnergyAccount watch;
  start(watch, {s.body, s.around}, s.start, 0);
  s.duration = h;
  for (int i = 0; i < steps; ++i) {
    s.start = run_with<Leapfrog>(s, 1).state;
    each(i, s);
    look(watch, {s.body, s.around}, s.start, h, 0);
  }
  return watch;
}

}  // namespace

TEST(a_vibration_at_nearly_the_largest_stable_step_gains_nothing) {
  const Oscillator o;
  const Scene s = scene(o, 1);
  double least = 1e300, most = 0;
  const EnergyAccount watch = watched_run(s, 1.9 / o.omega(), 1000, [&](int, const Scene& now) {
    least = std::min(least, energy(now));
    most = std::max(most, energy(now));
  });
  CHECK(most > 5 * least);                   // what a look at kinetic and elastic energy alone would see
  CHECK(watch.gained <= 1e-11 * energy(s));  // 1000 steps of rounding
  CHECK_NEAR(watch.balance, 0.0, 1e-11 * energy(s));
  CHECK(!alarm(watch, 0));
}

TEST(energy_out_of_nothing_is_seen_to_the_joule) {
  const Oscillator o;
  const Scene s = scene(o, 1);
  double given = 0;
  const EnergyAccount watch = watched_run(s, 0.1 / o.omega(), 100, [&](int i, Scene& now) {
    if (i != 50) return;
    given = -energy(now);
    now.start.v *= 1.2;
    given += energy(now);
  });
  CHECK(given > 0.01 * energy(s));
  CHECK_NEAR(watch.gained, given, 1e-11 * energy(s));
}

TEST(it_alarms_from_a_twentieth_of_the_energy_on) {
  for (const double factor : {1.02, 1.03}) {  // 4 and 6 per cent of the kinetic energy
    Scene s = scene({.y0 = 0, .w0 = 1}, 1);
    EnergyAccount watch;
    start(watch, {s.body, s.around}, s.start, 0);
    s.start.v *= factor;
    look(watch, {s.body, s.around}, s.start, 0, 0);
    CHECK(alarm(watch, 0) == (factor > 1.025));
    CHECK(!alarm(watch, energy(s)));  // rounding of that size is no gain
  }
}

TEST(what_a_body_had_long_ago_hides_no_gain) {
  for (const Count looks : {Count{1}, 3 * late_looks}) {
    Scene s = scene({.y0 = 0, .w0 = 1}, 1);
    EnergyAccount watch;
    start(watch, {s.body, s.around}, s.start, 0);
    s.start.v *= 0.1;  // a hundredth of the energy is left
    for (Count i = 0; i < looks; ++i) look(watch, {s.body, s.around}, s.start, 0, 0);
    s.start.v *= 1.5;
    look(watch, {s.body, s.around}, s.start, 0, 0);
    CHECK(alarm(watch, 0) == (looks > 1));
  }
}

TEST(losses_do_not_hide_gains) {
  Scene s = scene({.y0 = 0, .w0 = 1}, 1);
  const double full = energy(s);
  EnergyAccount watch;
  start(watch, {s.body, s.around}, s.start, 0);
  for (const double factor : {0.5, 1.5}) {
    s.start.v *= factor;
    look(watch, {s.body, s.around}, s.start, 0, 0);
  }
  CHECK_NEAR(watch.gained, (0.5625 - 0.25) * full, 1e-15);
  CHECK_NEAR(watch.balance, (0.5625 - 1) * full, 1e-15);
}

TEST(what_the_outside_gives_is_no_gain) {
  Scene s = scene({.f = 3}, 1);
  s.duration = 1e-3;
  EnergyAccount watch;
  start(watch, {s.body, s.around}, s.start, 0);
  double moved = 0;
  for (int i = 0; i < 300; ++i) {
    const Points before = s.start.x;
    s.start = run_with<Leapfrog>(s, 1).state;
    watch.received += (s.around.force * (s.start.x - before)).sum();
    moved += std::abs((s.around.force * (s.start.x - before)).sum());
    look(watch, {s.body, s.around}, s.start, s.duration, 0);
  }
  CHECK(moved > 1);
  CHECK(watch.gained < 1e-4 * moved);  // leapfrog keeps the energy of forces to (omega h)^2
}

TEST(a_jump_of_the_forces_is_no_gain) {
  const Oscillator o;
  Scene s = scene(o, 1);
  const double h = 1.5 / o.omega();
  EnergyAccount watch;
  start(watch, {s.body, s.around}, s.start, 0);
  s.duration = h;
  const Points none = s.around.force, pull = scene({.f = 40}, 1).around.force;
  double received = 0;
  for (int i = 0; i < 200; ++i) {
    const Points& now = i / 7 % 2 ? pull : none;
    if (!(now == s.around.force).all()) jolt(watch, s.body, s.start.spring, s.around.force, now);
    s.around.force = now;
    const Points before = s.start.x;
    s.start = run_with<Leapfrog>(s, 1).state;
    watch.received += (now * (s.start.x - before)).sum();
    received += std::abs((now * (s.start.x - before)).sum());
    look(watch, {s.body, s.around}, s.start, h, 0);
  }
  CHECK_NEAR(watch.gained, 0.0, 1e-11 * received);  // rounding: leapfrog keeps this energy exactly
}

TEST(an_account_that_is_no_number_is_an_alarm) {
  Scene s = scene({.y0 = 0, .w0 = 1}, 1);
  EnergyAccount watch;
  start(watch, {s.body, s.around}, s.start, 0);
  watch.received = std::numeric_limits<double>::quiet_NaN();
  look(watch, {s.body, s.around}, s.start, 0, 0);
  CHECK(alarm(watch, 1));
}
