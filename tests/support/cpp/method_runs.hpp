/// Runs of the methods over the scenes of ros34pw2_scenes.hpp, the two-mass oscillator whose motion is known, and the check of an order.
#pragma once
#include <type_traits>

#include "methods/bm4.hpp"
#include "methods/leapfrog.hpp"
#include "methods/rkn12.hpp"
#include "ros34pw2_scenes.hpp"

namespace softffd {

/// A given number of equal steps of any method. known: what stepping knows of the body and its steps.
inline Result run_method(Integrator& method, const Scene& s, int steps, bool watch = true, const Run& known = {}) {
  Drive drive = s.around;
  drive.watch = watch;
  Run run = known;
  run.physical.motion = s.start;
  run.physical.exchange.planes.resize(drive.planes.size());
  run.physical.exchange.pins.resize(drive.pins.size());
  CHECK(method.advance(Model(s.body), drive, {0, 0, s.duration / steps, steps}, run).status == StepStatus::ok);
  return {run.physical.motion, run.physical.exchange};
}

/// Leapfrog is made for a number of planes, the others for a number of pins.
template <class Method>
Result run_with(const Scene& s, int steps) {
  Method method(s.body.points(), int(std::is_same_v<Method, Leapfrog> ? s.around.planes.size() : s.around.pins.size()));
  return run_method(method, s, steps);
}

/// By leapfrog that carries velocities on for the dashpots, however long its steps.
inline Result run_carrying(const Scene& s, int steps, bool watch) {
  Leapfrog method(s.body.points(), 0);
  Run known;
  known.control.bound = known.control.damping_bound = 0;
  return run_method(method, s, steps, watch, known);
}

/// Steps whose forces, kicks and drift are one pass have the bits of those that are watched at every kick.
template <class Method>
void check_unwatched_steps() {
  for (const bool ramped : {false, true}) {
    const Scene s = soft(true, ramped);
    Method method(s.body.points(), 0);
    const State watched = run_method(method, s, 25).state, unwatched = run_method(method, s, 25, false).state;
    CHECK((watched.x == unwatched.x).all() && (watched.v == unwatched.v).all() && (watched.spring == unwatched.spring).all());
  }
}

using Stepping = Result (*)(const Scene&, int steps);

/// A frame that is thrown, accelerates and turns.
inline const Pin swinging = moving({0.3, 0.4, -0.2}, {2, -3, 1}, {0.5, -1, 2});

/// A method's claim, and two numbers of steps between which the error shows it.
struct Claim {
  double order;
  int coarse, fine;
  double less = 0.15;  ///< by which the order of the sums may be below it
  /// The order that two errors show.
  double shown(double large, double small) const { return std::log(large / small) / std::log(double(fine) / coarse); }
};

/// Errors of the positions fall with the claimed power of the step, to 0.15, and those of the velocities and of the sums (what pins
/// received, dissipated energy, work) at least so fast.
inline void check_order(const char* name, Stepping run, const Claim& claim, const Scene& s, const Result& exact) {
  const auto rms = [](const Points& a, const Points& b) { return std::sqrt((a - b).square().mean()); };
  const Result rough = run(s, claim.coarse), good = run(s, claim.fine);
  const Errors a = difference(rough, exact), b = difference(good, exact);
  const double x = claim.shown(rms(rough.state.x, exact.state.x), rms(good.state.x, exact.state.x));
  std::printf("  %s: x %.2f (errors %.1e and %.1e m)\n", name, x, a.x, b.x);
  CHECK_NEAR(x, claim.order, 0.15);
  for (double Errors::* part : {&Errors::v, &Errors::impulse, &Errors::torque, &Errors::dissipated, &Errors::work})
    if (!(a.*part < 1e-3 * a.x))  // else there is none, it is exact, or it happens to change its sign
      CHECK(claim.shown(a.*part, b.*part) > claim.order - claim.less);
}

/// The same with internal damping: of a body that is free, that has point damping too, that pins move.
inline void check_orders_with_dashpots(Stepping run, const Claim& claim, double time = 0.01) {
  for (const bool damped : {false, true}) {
    const Scene s = with_dashpots(soft(damped, true), time);
    check_order("dashpots", run, claim, s, reference(s));
  }
  Scene s = soft(false, true);
  pin_ends(s, swinging);
  s = with_dashpots(s, time);
  check_order("dashpots and pins", run, claim, s, reference(s));
}

/// Four pairs of points that springs join along x; whatever happens along x happens to all alike, and nothing else happens. The extension
/// y of a pair is a damped oscillator under a force that grows,
///
///      y'' + (d/m + tau omega^2) y' + omega^2 y = (f + g t) 2/m,      omega^2 = 2 k/m,
///
/// and the middle of a pair stays where it is.
struct Oscillator {
  double k = 50, m = 0.25, d = 0, f = 0, g = 0;  ///< [N/m], [kg], [N s/m], [N] and [N/s] outwards on each point
  double y0 = 0.1, w0 = 0.7;                     ///< extension [m] and its rate [m/s] at the start
  double tau = 0;                                ///< of dashpots along the springs [s]: damps as d = tau k does

  double omega() const { return std::sqrt(2 * k / m); }
  /// Extension [m] and its rate [m/s].
  std::array<double, 2> at(double t) const {
    const double c = (d + 2 * tau * k) / (2 * m), o2 = omega() * omega(), o = std::sqrt(o2 - c * c);
    const double slope = 2 * g / m / o2, level = (2 * f / m - 2 * c * slope) / o2;  // level + slope t follows the force
    const double p = y0 - level, q = (w0 - slope + c * p) / o, e = std::exp(-c * t), cosine = std::cos(o * t), sine = std::sin(o * t);
    return {level + slope * t + e * (p * cosine + q * sine), slope + e * ((o * q - c * p) * cosine - (o * p + c * q) * sine)};
  }
};

inline Scene scene(const Oscillator& o, double duration) {
  const Lattice lattice{{2, 2, 2}};
  Scene s{lattice, even_body(lattice, 0, 8 * o.m), no_forces(8), {}, duration};
  springs_of(s.body).set_stiffness({o.k, 0, 0}, {});
  s.body.damping.setConstant(o.d);
  springs_of(s.body).set_dashpots(o.tau);
  set_rates(s.body);
  s.around.ramped = o.g != 0;
  Points x = rest_positions(lattice), v = Points::Zero(8, 3);
  for (int p = 0; p < 8; ++p) {
    const double side = p % 2 == 0 ? -1 : 1;
    x(p, 0) += 0.5 * side * o.y0;
    v(p, 0) = 0.5 * side * o.w0;
    s.around.force(p, 0) = side * o.f;
    s.around.force_rate(p, 0) = side * o.g;
  }
  start_at(s, x, v);
  return s;
}

/// Largest error of the extension [m] or of its rate over omega.
inline double error(const Oscillator& o, const Scene& s, const State& end) {
  const auto [y, w] = o.at(s.duration);
  double error = 0;
  for (int p = 0; p < 8; p += 2)
    error = std::max({error, std::abs(end.x(p + 1, 0) - end.x(p, 0) - 1 - y), std::abs(end.v(p + 1, 0) - end.v(p, 0) - w) / o.omega()});
  return error;
}

/// The slope of the error between two numbers of steps, on the oscillator's exact motion over a second.
inline void check_oscillator_order(const Oscillator& o, Stepping run, const Claim& claim) {
  const Scene s = scene(o, 1);
  const double a = error(o, s, run(s, claim.coarse).state), b = error(o, s, run(s, claim.fine).state);
  CHECK_NEAR(claim.shown(a, b), claim.order, 0.15);
}

/// Free, damped, damped under a force that grows; and so by dashpots, where the method knows them.
inline void check_oscillator_orders(Stepping run, const Claim& claim, bool dashpots = true) {
  for (const Oscillator& o : {Oscillator{}, Oscillator{.d = 0.4}, Oscillator{.d = 0.4, .f = 1, .g = 5}})
    check_oscillator_order(o, run, claim);
  if (dashpots) check_oscillator_order({.f = 1, .g = 5, .tau = 0.02}, run, claim);
}

/// The error estimate of a single step falls with its order between two lengths [s], and is above the error.
template <class Method>
void check_estimate(const Oscillator& o, double order, double longer, double shorter) {
  double estimates[2];
  for (int i = 0; i < 2; ++i) {
    const Scene s = scene(o, i ? shorter : longer);
    Method method(s.body.points(), 0);
    method.time_scale.setConstant(1 / o.omega());
    method.ledger.open({s.body, s.around}, false);
    estimates[i] = method.attempt({s.body, s.around}, 0, s.duration, s.start);
    CHECK(estimates[i] > error(o, s, run_with<Method>(s, 1).state));
  }
  CHECK_NEAR(std::log(estimates[0] / estimates[1]) / std::log(longer / shorter), order, 0.15);
}

/// Back along the way that the method has come: forward, velocities turned round, forward. Distance from the start [m].
inline double way_back(const Scene& s, Stepping run, int steps) {
  Scene back = s;
  back.start = run(s, steps).state;
  back.start.v = -back.start.v;
  const State end = run(back, steps).state;
  return std::max(distance(end.x, s.start.x), distance(-end.v, s.start.v));
}

/// How far the Jacobian J of a step in (x, M v), by differences, is from J^T Omega J = Omega: of the size of the differences' own error,
/// 1e-8, for a symplectic method.
inline double symplectic_defect(const Scene& s, Stepping run) {
  const int n = int(s.start.x.size());
  const double d = 1e-5;
  const auto mass = [&](int i) { return s.body.mass[i % s.body.points()]; };
  Eigen::MatrixXd jacobian(2 * n, 2 * n);
  for (int c = 0; c < 2 * n; ++c) {
    Eigen::VectorXd ends[2];
    for (int side = 0; side < 2; ++side) {
      Points x = s.start.x, v = s.start.v;
      (c < n ? x.data()[c] : v.data()[c - n]) += (side ? d : -d) / (c < n ? 1 : mass(c - n));
      Scene moved = s;
      start_at(moved, x, v);
      const State end = run(moved, 1).state;
      ends[side].resize(2 * n);
      for (int i = 0; i < n; ++i) ends[side][i] = end.x.data()[i], ends[side][n + i] = mass(i) * end.v.data()[i];
    }
    jacobian.col(c) = (ends[1] - ends[0]) / (2 * d);
  }
  Eigen::MatrixXd omega = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  for (int i = 0; i < n; ++i) omega(i, n + i) = 1, omega(n + i, i) = -1;
  return (jacobian.transpose() * omega * jacobian - omega).cwiseAbs().maxCoeff();
}

}  // namespace softffd
