/// Bodies for tests of the linearly implicit method, runs of them without a propagator, and what they are compared by.
#pragma once
#include <cstring>

#include "bodies.hpp"
#include "body/stability.hpp"
#include "check.hpp"
#include "methods/dop853.hpp"
#include "methods/ros34pw2.hpp"

namespace softffd {

/// Too wide for a factor: conjugate gradients solve.
inline const Lattice wide{{9, 9, 9}};

struct Scene {
  Lattice lattice;
  Body body;
  Drive around;
  State start;
  double duration;  ///< [s]
};

inline void set_rates(Body& body) {
  const int n = body.points();
  body.inverse_mass = body.damping_rate = Scalars::Zero(3 * n);
  body.damped = (body.damping > 0).any() || body.dashpots();
  for (int i = 0; i < 3 * n; ++i)
    if (!body.pinned[i % n]) {
      body.inverse_mass[i] = 1 / body.mass[i % n];
      body.damping_rate[i] = body.damping[i % n] / body.mass[i % n];
    }
  Stability stability(n);
  stability.prepare(body);
  body.fastest_damping = body.damping_rate.maxCoeff() + body.longest_time() * std::pow(stability.any_frequency(), 2);
}

inline void start_at(Scene& scene, const Points& x, const Points& v) {
  scene.start.x = x;
  scene.start.v = v;
  Equations{scene.body, scene.around}.place_pins(0, scene.start.x, scene.start.v);
  scene.start.spring.resize(x.rows(), 3);
  scene.body.internal_force(scene.start.x, scene.start.spring);
}

/// Soft, stretched and moving, so that every term counts: forces that ramp, masses and (where asked) damping that differ from point to
/// point.
inline Scene soft(bool damped = false, bool ramped = false, const Lattice& lattice = {{3, 4, 2}}) {
  const int n = lattice.points();
  Scene s{lattice, even_body(lattice), no_forces(n), {}, 0.5};
  springs_of(s.body).set_stiffness({30, 20, 10}, {});
  Points x = rest_positions(lattice), v(n, 3);
  x.col(0) *= 1.1;
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

/// The scene with dashpots along its springs [s].
inline Scene with_dashpots(Scene s, double time) {
  springs_of(s.body).set_dashpots(time);
  set_rates(s.body);
  return s;
}

/// Two frames hold the ends of the longest axis.
inline void pin_ends(Scene& s, const Pin& motion) {
  const Points rest = rest_positions(s.lattice);
  for (int j : {0, s.lattice.counts[1] - 1}) {
    std::vector<int> points;
    for (int i = 0; i < s.lattice.counts[0]; ++i) points.push_back(s.lattice.index(i, j, 0));
    s.around.pins.push_back(pin_points(s.body, rest, points, j == 0 ? Pin{} : motion));
  }
  set_rates(s.body);
  start_at(s, Points(s.start.x), Points(s.start.v));
}

inline Pin moving(const Vec3& velocity, const Vec3& acceleration, const Vec3& spin = Vec3::Zero()) {
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

inline void accept(OneStep& method, const Scene& s, double h, Result& r) {
  method.ledger.add_to(r.exchange);
  r.state.x.swap(method.x);
  r.state.v.swap(method.v);
  r.state.time += h;
  s.body.internal_force(r.state.x, r.state.spring);
}

inline Result begin(const Scene& s) {
  Result r{s.start, {}};
  r.exchange.pins.resize(s.around.pins.size());
  return r;
}

template <class BeforeStep>
inline Result run(OneStep& method, const Scene& s, int steps, const BeforeStep& before_step) {
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

inline Result run(OneStep& method, const Scene& s, int steps) {
  return run(method, s, steps, [] {});
}

inline Result run_fresh(Ros34pw2& method, const Scene& s, int steps) {
  return run(method, s, steps, [&] { method.refresh(); });
}

inline Result reference(const Scene& s, int steps = 400) {
  Dop853 method(s.body.points(), int(s.around.pins.size()));
  return run(method, s, steps);
}

struct Errors {
  double x, v, impulse, torque, dissipated, work;
};

inline Errors difference(const Result& a, const Result& b) {
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
inline void check_third_order(const char* name, const Errors& coarse, const Errors& fine) {
  const auto order = [&](double Errors::* part) { return std::log2(coarse.*part / (fine.*part)); };
  std::printf("  %s: x %.2f v %.2f\n", name, order(&Errors::x), order(&Errors::v));
  CHECK_NEAR(order(&Errors::x), 3.0, 0.15);
  CHECK_NEAR(order(&Errors::v), 3.0, 0.15);
  for (double Errors::* part : {&Errors::impulse, &Errors::torque, &Errors::dissipated, &Errors::work})
    CHECK(coarse.*part < 1e-13 || order(part) > 2.85);  // there is none, or it is exact
}

inline void check_third_order(const char* name, const Scene& s) {
  const Result exact = reference(s);
  Ros34pw2 coarse(s.lattice, int(s.around.pins.size())), fine(s.lattice, int(s.around.pins.size()));
  check_third_order(name, difference(run_fresh(coarse, s, 160), exact), difference(run_fresh(fine, s, 320), exact));
}

/// Momentum that the whole body has taken up, plus what damping took and the pins received, less what the forces gave [N s].
inline double momentum_lost(const Scene& s, const Result& r) {
  Vec3 sum = Vec3::Zero();
  for (int p = 0; p < s.body.points(); ++p) {
    sum += s.body.mass[p] * (row(r.state.v, p) - row(s.start.v, p)) + s.body.damping[p] * (row(r.state.x, p) - row(s.start.x, p));
    sum -= s.duration * (row(s.around.force, p) + 0.5 * s.duration * row(s.around.force_rate, p));
  }
  for (const Impulse& pin : r.exchange.pins) sum += pin.force;
  return sum.norm();
}

inline bool same_bits(const Points& a, const Points& b) { return std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0; }

/// The 64-point block of 1 kg, k = 1e7 N/m, pulled apart by forces that grow over 0.5 s; one stretch of 0.1 s with linear growth.
inline Scene stiff() {
  const Lattice lattice;
  Scene s{lattice, even_body(lattice, 1e7), no_forces(64), {}, 0.1};
  s.body.damping.setConstant(0.5);
  set_rates(s.body);
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

inline Conserved conserved(const Scene& s, const State& state) {
  Conserved c{s.body.elastic_energy(state.x), Vec3::Zero()};
  for (int p = 0; p < s.body.points(); ++p) {
    c.energy += 0.5 * s.body.mass[p] * row(state.v, p).squaredNorm();
    c.angular += s.body.mass[p] * row(state.x, p).cross(row(state.v, p));
  }
  return c;
}

}  // namespace softffd
