/// Energy out of nothing: a body has no more energy than it was given, but explicit steps near the stability bound can feed its vibrations,
/// by resonance with the springs' nonlinearity, through friction or where crushed cells stiffen within a step, without end and without an
/// error estimate that says so. Damping takes energy, so that its loss need not be known.
///
/// What counts as its energy is what leapfrog keeps of it, with the velocities half a step before and after in place of v^2:
///
///      sum m/2 (v - h F/2m)(v + h F/2m) + V  =  kinetic + elastic - h^2/8 sum F^2/m.
///
/// A linear body keeps this exactly, while kinetic + elastic goes up and down by (omega h / 2)^2 of itself: at steps near the bound by
/// many times, without harm. The other methods have no such step: there h counts as 0.
///
/// Gains are summed from the lowest point on, so that what a body has lost does not hide what it gains. Looks are rare where communication
/// steps are short: they cost an evaluation of the energy.
#pragma once
#include "forces/equations.hpp"
#include "model/state.hpp"

namespace softffd {

struct EnergyWatch {
  /// Share of the largest energy so far from which on a gain is an alarm.
  static constexpr double most_gain = 0.05;

  double kinetic_elastic = -1;  ///< when last looked at [J]; negative: not yet
  double forces = 0;            ///< sum of F^2/m over the free points then [N^2/kg]
  double received = 0;          ///< work of the outside since then, less what friction and impacts took [J]
  double gained = 0;            ///< out of nothing, from the lowest point on [J]
  double balance = 0;           ///< all gains and losses [J]
  double largest = 0;           ///< energy so far [J]
  double due = 0;               ///< work of the course at which the next look is due
  double share = 1;             ///< of the usual internal step that has proved safe
  bool hopeless = false;        ///< smaller steps did not help

  /// Begins anew at a state that was not reached by motion alone.
  void start(const Equations& equations, const State& state, double work);
  /// The outside forces jump [N] while the spring forces are these: no gain, though what counts as energy jumps too.
  void jolt(const Body& body, const Points& spring, const Points& before, const Points& after);
  /// Looks at a state that steps of size h (0: of another method than leapfrog) have led to.
  void look(const Equations& equations, const State& state, double h, double work);
  /// Whether the body has gained more than it may. Below `noise` [J] everything is rounding.
  bool alarm(double noise) const { return gained > most_gain * largest + noise; }
};

}  // namespace softffd
