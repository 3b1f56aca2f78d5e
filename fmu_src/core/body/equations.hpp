/// The equations of motion between contacts, as the smooth methods evaluate them at their stages:
///
///      x' = v,      M v' = spring forces(x) + outside forces(t) - D v - C(x) v,
///
/// D being the points' damping, C that of the dashpots along the springs.
///
/// Pinned points are no unknowns: they are where their frame is at the time of the stage, and their acceleration counts as zero.
#pragma once
#include "body/body.hpp"
#include "model/drive.hpp"
#include "model/exchange.hpp"

namespace softffd {

struct Equations {
  const Body& body;
  const Drive& around;

  /// Puts the pinned points of x on their frames at time t.
  void place_pins(double t, Points& x) const;
  /// The same for velocities too.
  void place_pins(double t, Points& x, Points& v) const;
  /// Outside forces at time t [N]; `scratch` holds them where they ramp.
  const Points& outside(double t, Points& scratch) const;
  /// Forces of springs and dashpots at (x, v) [N], those of the springs known; `scratch` holds them where there are dashpots.
  const Points& inner(const Points& x, const Points& v, const Points& spring, Points& scratch) const;
  /// a = accelerations at (t, x, v) [m/s2] and inner = forces of springs and dashpots [N]; v is not read without damping.
  void acceleration(double t, const Points& x, const Points& v, Points& scratch, Points& inner, Points& a) const;
  /// The same with the inner forces known.
  void acceleration(double t, const Points& v, const Points& inner, Points& scratch, Points& a) const;
};

/// Time integrals that a step's exchange with the outside consists of, by the quadrature of the method itself, so that they have its order:
/// impulses on the pins, energy lost to damping, work of ramped forces. The inertia of pinned points and the ramp's work are integrated
/// by parts; what is left needs positions, velocities and forces at the stages alone.
class Ledger {
 public:
  explicit Ledger(int pins) : pins_(pins) {}

  /// Begins a step. Without pins and unless `watch`ed nothing will be recorded. lossy: the method itself takes energy.
  void open(const Equations& equations, bool watch, bool lossy = false);
  bool recording() const { return recording_; }
  /// Adds weight [s] times the rates at a stage, damping's loss apart. inner: forces of springs and dashpots [N].
  void stage(const Equations& equations, double weight, double t, const Points& x, const Points& inner);
  /// Adds what damping takes in `weight` [s] of points at x that move with v.
  void damp(const Equations& equations, double weight, const Points& x, const Points& v);
  /// Adds what the step's two ends contribute.
  void ends(const Equations& equations, double t0, const Points& x0, const Points& v0, double t1, const Points& x1, const Points& v1);
  /// Adds work [J] and dissipated energy [J] as the method has them.
  void book(double work, double dissipated) { work_ += work, dissipated_ += dissipated; }
  /// Hands the step's sums to the exchange.
  void settle(Exchange& exchange) const;

 private:
  void end(const Equations& equations, double sign, double t, const Points& x, const Points& v);
  std::vector<Impulse> pins_;
  double dissipated_ = 0, work_ = 0;
  bool watch_ = false, recording_ = false;
};

}  // namespace softffd
