#include <cstring>

#include "check.hpp"
#include "dop853.hpp"
#include "ros34pw2.hpp"

using namespace softffd;

namespace {

struct Scene {
  Lattice lattice;
  Body body;
  Surroundings around;
  State start;
  double duration;  ///< [s]
};

void set_rates(Body& body) {
  const int n = body.points();
  body.inverse_mass = body.damping_rate = Scalars::Zero(3 * n);
  body.damped = (body.damping > 0).any();
  for (int i = 0; i < 3 * n; ++i)
    if (!body.pinned[i % n]) {
      body.inverse_mass[i] = 1 / body.mass[i % n];
      body.damping_rate[i] = body.damping[i % n] / body.mass[i % n];
    }
}

void start_at(Scene& scene, const Points& x, const Points& v) {
  scene.start.x = x;
  scene.start.v = v;
  Equations{scene.body, scene.around}.place_pins(0, scene.start.x, scene.start.v);
  scene.start.spring.resize(x.rows(), 3);
  scene.body.springs.force(scene.start.x, scene.start.spring);
}

/// Soft, stretched and moving, so that every term counts: forces that ramp, masses and (where asked) damping that differ from point to
/// point.
Scene soft(bool damped = false, bool ramped = false) {
  const Lattice lattice{{3, 4, 2}};
  const int n = lattice.points();
  Scene s{lattice, {Springs(lattice, Topology::distinct), Scalars(n), Scalars::Zero(n), std::vector<bool>(n, false)}, {}, {}, 0.5};
  s.body.springs.set_stiffness({30, 20, 10}, {});
  Points x = rest_positions(lattice), v(n, 3);
  x.col(0) *= 1.1;
  s.around.force.resize(n, 3);
  s.around.force_rate.setZero(n, 3);
  s.around.ramped = ramped;
  for (int p = 0; p < n; ++p) {
    s.body.mass[p] = 0.1 + 0.02 * std::sin(p);
    if (damped) s.body.damping[p] = 0.3 + 0.1 * std::cos(p);
    for (int a = 0; a < 3; ++a) {
      v(p, a) = 0.5 * std::sin(2.0 * p + a);
      s.around.force(p, a) = std::cos(3.0 * p + a);
      if (ramped) s.around.force_rate(p, a) = 4 * std::sin(5.0 * p + a);
    }
  }
  set_rates(s.body);
  start_at(s, x, v);
  return s;
}

/// Two frames hold the ends of the longest axis.
void pin_ends(Scene& s, const Pin& motion) {
  const Points rest = rest_positions(s.lattice);
  for (int j : {0, s.lattice.counts[1] - 1}) {
    Pin pin = j == 0 ? Pin{} : motion;
    for (int i = 0; i < s.lattice.counts[0]; ++i) pin.points.push_back(s.lattice.index(i, j, 0));
    for (int p : pin.points) pin.position += row(rest, p) / double(pin.points.size());
    for (int p : pin.points) {
      pin.local.push_back(row(rest, p) - pin.position);
      s.body.pinned[p] = true;
    }
    s.around.pins.push_back(pin);
  }
  set_rates(s.body);
  start_at(s, Points(s.start.x), Points(s.start.v));
}

Pin moving(const Vec3& velocity, const Vec3& acceleration, const Vec3& spin = Vec3::Zero()) {
  Pin pin;
  pin.velocity = velocity;
  pin.acceleration = acceleration;
  pin.angular_velocity = spin;
  return pin;
}

struct Result {
  State state;
  Exchange exchange;
};

void accept(OneStep& method, const Scene& s, double h, Result& r) {
  method.ledger.settle(r.exchange);
  r.state.x.swap(method.x);
  r.state.v.swap(method.v);
  r.state.time += h;
  s.body.springs.force(r.state.x, r.state.spring);
}

Result begin(const Scene& s) {
  Result r{s.start, {}};
  r.exchange.pins.resize(s.around.pins.size());
  return r;
}

template <class BeforeStep>
Result run(OneStep& method, const Scene& s, int steps, const BeforeStep& before_step) {
  Result r = begin(s);
  const Equations equations{s.body, s.around};
  const double h = s.duration / steps;
  for (int i = 0; i < steps; ++i) {
    before_step();
    method.ledger.open(equations, true);
    method.attempt(equations, i * h, h, r.state);
    accept(method, s, h, r);
  }
  return r;
}

Result run(OneStep& method, const Scene& s, int steps) {
  return run(method, s, steps, [] {});
}

Result run_fresh(Ros34pw2& method, const Scene& s, int steps) {
  return run(method, s, steps, [&] { method.refresh(); });
}

Result reference(const Scene& s, int steps = 400) {
  Dop853 method(s.body.points(), int(s.around.pins.size()));
  return run(method, s, steps);
}

double distance(const Points& a, const Points& b) { return (a - b).abs().maxCoeff(); }

struct Errors {
  double x, v, impulse, torque, dissipated, work;
};

Errors difference(const Result& a, const Result& b) {
  Errors e{distance(a.state.x, b.state.x),
           distance(a.state.v, b.state.v),
           0,
           0,
           std::abs(a.exchange.dissipated - b.exchange.dissipated),
           std::abs(a.exchange.work - b.exchange.work)};
  for (std::size_t p = 0; p < a.exchange.pins.size(); ++p) {
    e.impulse = std::max(e.impulse, (a.exchange.pins[p].force - b.exchange.pins[p].force).norm());
    e.torque = std::max(e.torque, (a.exchange.pins[p].torque - b.exchange.pins[p].torque).norm());
  }
  return e;
}

/// log2 of the ratio of two errors must be near 3 for the state and at least that for the sums.
void check_third_order(const char* name, const Errors& coarse, const Errors& fine) {
  const auto order = [](double a, double b) { return std::log2(a / b); };
  std::printf("  %s: x %.2f v %.2f", name, order(coarse.x, fine.x), order(coarse.v, fine.v));
  CHECK_NEAR(order(coarse.x, fine.x), 3.0, 0.15);
  CHECK_NEAR(order(coarse.v, fine.v), 3.0, 0.15);
  const auto at_least = [&](const char* what, double a, double b) {
    if (a < 1e-13) return;  // there is none, or it is exact
    std::printf(" %s %.2f", what, order(a, b));
    CHECK(order(a, b) > 2.85);
  };
  at_least("impulse", coarse.impulse, fine.impulse);
  at_least("torque", coarse.torque, fine.torque);
  at_least("dissipated", coarse.dissipated, fine.dissipated);
  at_least("work", coarse.work, fine.work);
  std::printf("  (error %.1e m)\n", fine.x);
}

void check_third_order(const char* name, const Scene& s) {
  const Result exact = reference(s);
  Ros34pw2 coarse(s.lattice, int(s.around.pins.size())), fine(s.lattice, int(s.around.pins.size()));
  check_third_order(name, difference(run_fresh(coarse, s, 160), exact), difference(run_fresh(fine, s, 320), exact));
}

/// Momentum that the whole body has taken up, plus what damping took and the pins received, less what the forces gave [N s].
double momentum_lost(const Scene& s, const Result& r) {
  Vec3 sum = Vec3::Zero();
  for (int p = 0; p < s.body.points(); ++p) {
    sum += s.body.mass[p] * (row(r.state.v, p) - row(s.start.v, p)) + s.body.damping[p] * (row(r.state.x, p) - row(s.start.x, p));
    sum -= s.duration * (row(s.around.force, p) + 0.5 * s.duration * row(s.around.force_rate, p));
  }
  for (const Impulse& pin : r.exchange.pins) sum += pin.force;
  return sum.norm();
}

bool same_bits(const Points& a, const Points& b) { return std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0; }

/// The 64-point block of 1 kg, k = 1e7 N/m, pulled apart by forces that grow over 0.5 s; one stretch of 0.1 s with linear growth.
Scene stiff() {
  const Lattice lattice;
  Scene s{lattice,
          {Springs(lattice, Topology::distinct), Scalars::Constant(64, 1.0 / 64), Scalars::Constant(64, 0.5), std::vector<bool>(64, false)},
          {},
          {},
          0.1};
  s.body.springs.set_stiffness({1e7, 1e7, 1e7}, {});
  set_rates(s.body);
  s.around.force.setZero(64, 3);
  s.around.force_rate.setZero(64, 3);
  s.around.force.col(2) = -9.81 / 64;
  s.around.ramped = true;
  for (int j = 0; j < 4; ++j)
    for (int k = 0; k < 4; ++k)
      for (int i : {0, 3}) s.around.force_rate(lattice.index(i, j, k), 0) = (i == 0 ? -1 : 1) * 1e5 * (1 + j / 3.0) / 0.5;
  start_at(s, rest_positions(lattice), Points::Zero(64, 3));
  return s;
}

struct Conserved {
  double energy;
  Vec3 angular;
};

Conserved conserved(const Scene& s, const State& state) {
  Conserved c{s.body.springs.energy(state.x), Vec3::Zero()};
  for (int p = 0; p < s.body.points(); ++p) {
    c.energy += 0.5 * s.body.mass[p] * row(state.v, p).squaredNorm();
    c.angular += s.body.mass[p] * row(state.x, p).cross(row(state.v, p));
  }
  return c;
}

/// The block with k = 1e5 N/m and without damping, set spinning at 20 rad/s about its middle out of its rest shape; one turn.
Scene spin() {
  Scene s = stiff();
  s.body.springs.set_stiffness({1e5, 1e5, 1e5}, {});
  s.body.damping.setZero();
  set_rates(s.body);
  s.around = {};
  s.around.force.setZero(64, 3);
  s.duration = 2 * 3.14159265358979 / 20;
  Points x = rest_positions(s.lattice) - 0.5, v = Points::Zero(64, 3);
  v.col(0) = -20 * x.col(1);
  v.col(1) = 20 * x.col(0);
  start_at(s, x, v);
  return s;
}

}  // namespace

TEST(third_order_with_the_stiffness_of_each_step) {
  check_third_order("free", soft());
  check_third_order("damped", soft(true));
  check_third_order("ramped", soft(false, true));
  check_third_order("damped and ramped", soft(true, true));
}

TEST(third_order_while_pins_move) {
  const std::pair<const char*, Pin> motions[] = {{"fixed pins", moving({0, 0, 0}, {0, 0, 0})},
                                                 {"steady pins", moving({0.3, 0.4, -0.2}, {0, 0, 0})},
                                                 {"accelerating pins", moving({0.3, 0.4, -0.2}, {2, -3, 1})},
                                                 {"turning pins", moving({0.3, 0.4, -0.2}, {0, 0, 0}, {0.5, -1, 2})}};
  for (const auto& [name, motion] : motions) {
    Scene s = soft(true, true);
    pin_ends(s, motion);
    check_third_order(name, s);
  }
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
    errors[i] = difference(run(method, s, steps, [&] { method.factored = {foreign, s.duration / steps, 0}; }), exact);
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
  for (bool damped : {false, true}) {
    Scene s = soft(damped, true);
    pin_ends(s, moving({0.3, 0.4, -0.2}, {0, 0, 0}));
    Ros34pw2 method(s.lattice, 2);
    CHECK_NEAR(momentum_lost(s, run(method, s, 10)), 0.0, 1e-13);  // momenta of 1 N s
  }
}

TEST(a_free_body_keeps_its_momentum_to_rounding) {
  const Scene s = soft();
  Ros34pw2 method(s.lattice, 0);
  CHECK_NEAR(momentum_lost(s, run(method, s, 10)), 0.0, 1e-14);
}

TEST(a_body_carried_along_steadily_feels_nothing) {
  Scene s = soft();
  const Vec3 velocity(3, -4, 5);
  s.around.force.setZero();
  pin_ends(s, moving(velocity, {0, 0, 0}));
  s.around.pins[0].velocity = velocity;
  const Points rest = rest_positions(s.lattice);
  s.start.v = velocity.transpose().array().replicate(rest.rows(), 1);
  s.body.springs.set_stiffness({1e9, 1e9, 1e9}, {});
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
    std::printf("  h = %g ms, omega h / 2 = %.0f: error %.1e m\n", 1e3 * s.duration / steps, 0.5 * 9.3e4 * s.duration / steps, error);
    CHECK(error < 1e-5);  // the load moves points by 2e-2 m
    if (before > 0) CHECK(error < before / 4);
    before = error;
  }
}

TEST(a_stiff_body_follows_an_accelerating_pin) {
  Scene s = stiff();
  s.around.force.setZero();
  s.around.force_rate.setZero();
  s.around.ramped = false;
  Pin pin = moving({0.2, 0, 0}, {10, 0, 0});
  const Points rest = rest_positions(s.lattice);
  for (int j = 0; j < 4; ++j)
    for (int k = 0; k < 4; ++k) pin.points.push_back(s.lattice.index(0, j, k));
  pin.position = {0, 0.5, 0.5};
  for (int p : pin.points) {
    pin.local.push_back(row(rest, p) - pin.position);
    s.body.pinned[p] = true;
  }
  s.around.pins.push_back(pin);
  set_rates(s.body);
  Points v = Points::Zero(64, 3);
  v.col(0) = 0.2;
  start_at(s, rest, v);
  const Result exact = reference(s, 4000);
  for (int steps : {5, 10}) {
    Ros34pw2 method(s.lattice, 1);
    const Errors e = difference(run(method, s, steps), exact);
    std::printf("  h = %g ms: position %.1e m of 7e-2, impulse %.1e of 3.2 N s, dissipated %.1e of 1.8 J, work %.1e of 2.5 J\n",
                1e3 * s.duration / steps, e.x, e.impulse, e.dissipated, e.work);
    CHECK(e.x < 3e-6);
    // the sudden start lets the exact body ring, which long steps pass over
    CHECK(e.impulse < 2e-4 && e.dissipated < 1e-4 && e.work < 3e-3);
  }
}

TEST(the_error_estimate_finds_a_factor_that_is_too_old) {
  const Scene s = stiff();
  const Equations equations{s.body, s.around};
  const double h = 0.02;
  Ros34pw2 method(s.lattice, 0);
  Result r = begin(s);
  for (int i = 0; i < 2; ++i) {
    method.ledger.open(equations, false);
    CHECK(method.attempt(equations, i * h, h, r.state) < 1e-4);
    accept(method, s, h, r);
  }
  // under load the body resists turning, of which the unloaded stiffness knows nothing
  CHECK(method.attempt(equations, 2 * h, h, r.state) > 1);
  method.refresh();
  CHECK(method.attempt(equations, 2 * h, h, r.state) < 1e-4);
}

TEST(an_undamped_spin_drifts_and_less_with_finer_steps) {
  const Scene s = spin();
  const Conserved start = conserved(s, s.start);
  double before = 0;
  for (int steps : {400, 800, 1600}) {
    Ros34pw2 method(s.lattice, 0);
    const Conserved end = conserved(s, run_fresh(method, s, steps).state);
    const double energy = end.energy / start.energy - 1, angular = end.angular.norm() / start.angular.norm() - 1;
    std::printf("  one turn in %d steps: energy %+.1e, angular momentum %+.1e\n", steps, energy, angular);
    if (before > 0) CHECK(std::abs(angular) < before / 6);
    before = std::abs(angular);
  }
}

TEST(a_factor_serves_twenty_steps) {
  const Scene s = soft(true);
  Ros34pw2 method(s.lattice, 0);
  CHECK(method.factorizations() == 0);
  run(method, s, 45);
  CHECK(method.factorizations() == 3);
}

TEST(a_fresh_factor_belongs_to_the_state_at_hand) {
  const Scene s = soft(true);
  const Equations equations{s.body, s.around};
  Ros34pw2 method(s.lattice, 0);
  const Result r = run(method, s, 5);
  CHECK(same_bits(method.factored.x, s.start.x) && method.factored.uses == 5);
  method.refresh();
  method.attempt(equations, s.duration, s.duration / 5, r.state);
  CHECK(same_bits(method.factored.x, r.state.x) && method.factored.uses == 1 && method.factorizations() == 2);
  method.attempt(equations, s.duration, s.duration / 7, r.state);
  CHECK(method.factored.h == s.duration / 7 && method.factorizations() == 3);
}

TEST(a_restored_factor_continues_with_the_same_bits) {
  Scene s = soft(true, true);
  pin_ends(s, moving({0.3, 0.4, -0.2}, {2, -3, 1}));
  const Equations equations{s.body, s.around};
  const double h = 0.01;
  const auto advance = [&](Ros34pw2& method, Result& r, int first, int count) {
    for (int i = first; i < first + count; ++i) {
      method.ledger.open(equations, true);
      method.attempt(equations, i * h, h, r.state);
      accept(method, s, h, r);
    }
  };
  Ros34pw2 whole(s.lattice, 2), other(s.lattice, 2);
  Result r = begin(s);
  advance(whole, r, 0, 7);
  const Factored saved = whole.factored;
  Result copy = r;
  advance(whole, r, 7, 20);
  other.factored = saved;
  advance(other, copy, 7, 20);
  CHECK(same_bits(r.state.x, copy.state.x) && same_bits(r.state.v, copy.state.v));
  CHECK(r.exchange.work == copy.exchange.work && r.exchange.pins[1].torque == copy.exchange.pins[1].torque);
  CHECK(whole.factorizations() == 2 && other.factorizations() == 2);
}

TEST(a_changed_body_gets_its_own_factor) {
  Scene s = soft();
  Ros34pw2 method(s.lattice, 0), fresh(s.lattice, 0);
  const double h = 0.01;
  const Equations equations{s.body, s.around};
  method.attempt(equations, 0, h, s.start);
  const Points before = method.x;
  s.body.springs.set_stiffness({300, 200, 100}, {});
  start_at(s, Points(s.start.x), Points(s.start.v));
  method.body_changed();
  method.attempt(equations, 0, h, s.start);
  fresh.attempt(equations, 0, h, s.start);
  CHECK(same_bits(method.x, fresh.x) && !same_bits(method.x, before) && method.factorizations() == 2);
}

TEST(a_state_without_numbers_has_an_error_without_a_number) {
  Scene s = soft();
  s.start.x(3, 1) = std::nan("");
  s.body.springs.force(s.start.x, s.start.spring);
  Ros34pw2 method(s.lattice, 0);
  const double error = method.attempt({s.body, s.around}, 0, 0.01, s.start);
  CHECK(!(error <= 1e300));
}
