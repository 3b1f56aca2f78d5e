/// The equations of motion between contacts, as the smooth methods evaluate them at their stages:
///
///      x' = v,      M v' = spring forces(x) + outside forces(t) - D v - C(x) v,
///
/// D is the nodal viscous drag, C the matrix of the dashpots along the springs.
///
/// Pinned points are not unknowns: they are where their frame is at the time of the stage, and their acceleration counts as zero.
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
  /// Puts the pinned points of x on their frames at time t and sets their velocities.
  void place_pins(double t, Points& x, Points& v) const;
  /// Returns the outside forces at time t [N]; `scratch` holds the forces if they ramp.
  const Points& outside(double t, Points& scratch) const;
  /// Returns the forces of springs and dashpots at (x, v) [N] from known spring forces; `scratch` holds the sum if there are dashpots.
  const Points& inner(const Points& x, const Points& v, const Points& spring, Points& scratch) const;
  /// Computes a = accelerations at (t, x, v) [m/s2] and inner = forces of springs and dashpots [N]; v is not read without damping.
  void acceleration(double t, const Points& x, const Points& v, Points& scratch, Points& inner, Points& a) const;
  /// Computes the same accelerations from known inner forces.
  void acceleration(double t, const Points& v, const Points& inner, Points& scratch, Points& a) const;
};

/// Time integrals that make up a step's exchange with the outside: impulses on the pins, energy lost to damping, work of ramped forces.
/// The quadrature of the method itself computes the integrals, so that they have its order. The inertia of pinned points and the work of
/// the ramp are integrated by parts; the rest needs only positions, velocities and forces at the stages.
class Ledger {
 public:
  explicit Ledger(int pins) : pins_(pins) {}

  /// Begins a step. Without pins, nothing is recorded unless `watch` is set. lossy: the method itself takes energy.
  void open(const Equations& equations, bool watch, bool lossy = false);
  bool recording() const { return recording_; }
  /// Adds weight [s] times the rates at a stage, except the loss to damping. inner: forces of springs and dashpots [N].
  void stage(const Equations& equations, double weight, double t, const Points& x, const Points& inner);
  /// Adds the energy that damping takes in the time `weight` [s] from points at x with velocities v.
  void damp(const Equations& equations, double weight, const Points& x, const Points& v);
  /// Adds the contributions of the two ends of the step.
  void ends(const Equations& equations, double t0, const Points& x0, const Points& v0, double t1, const Points& x1, const Points& v1);
  /// Adds work [J] and dissipated energy [J] that the method itself has computed.
  void book(double work, double dissipated) { work_ += work, dissipated_ += dissipated; }
  /// Adds the sums of the step to the exchange.
  void add_to(Exchange& exchange) const;

 private:
  void end(const Equations& equations, double sign, double t, const Points& x, const Points& v);
  std::vector<Impulse> pins_;
  double dissipated_ = 0, work_ = 0;
  bool watch_ = false, recording_ = false;
};

}  // namespace softffd
