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
/// A stiff body's flights and the windows between them have different ones: there it is looked at in flights alone, with h = 0, so that
/// what changing from one to the other adds is seen; what impacts take is not known then, and hides as much.
///
/// Gains are summed from the lowest point on, so that what a body has lost does not hide what it gains. Looks are rare where communication
/// steps are short: they cost an evaluation of the energy.
#pragma once
#include <algorithm>

#include "body/equations.hpp"
#include "body/model.hpp"
#include "model/run.hpp"

namespace softffd {

/// Part of the largest energy of late from which on a gain is an alarm [1]: smaller ones are errors within the tolerance, by experience. So
/// many looks are late: a body that has come to rest must not gain what was little when it fell.
inline constexpr double most_gain = 0.05;
inline constexpr Count late_looks = 64;

/// Begins anew at a state that was not reached by motion alone.
void start(EnergyAccount& account, const Equations& equations, const State& state, double work);
/// The outside forces jump [N] while the spring forces are these: no gain, though what counts as energy jumps too.
void jolt(EnergyAccount& account, const Body& body, const Points& spring, const Points& before, const Points& after);
/// Looks at a state that steps of size h (0: of another method than leapfrog) have led to.
void look(EnergyAccount& account, const Equations& equations, const State& state, double h, double work);
/// Whether the body has gained more than it may. Below `noise` [J] everything is rounding.
inline bool alarm(const EnergyAccount& account, double noise) {
  return !(account.gained <= most_gain * std::max(account.recent, account.earlier) + noise);
}
/// What counts as h: the last step of leapfrog and of the central difference, whose velocities stand between positions.
double staggered_step(const Run& run);
/// Energy that the method has taken until now [J]; below 0: gained.
double lost(EnergyAccount account, const Equations& equations, const Run& run);

// ---- the account of a communication step ----

/// Displacement relative to the box from which on a jump of points begins the account anew [1]. By experience.
inline constexpr double far_jump = 1e-3;

/// Books what moved points without the body's own motion. changed: the material is another than before; moved: planes or pins have moved
/// points. Returns what of the exchange's work is booked already.
double open_account(Run& now, const Run& before, const Model& model, const Drive& drive, bool changed, bool moved);
/// The same with and without energy outputs: what only they have counted is not read. begin: positions at the start.
void close_account(Run& now, const Model& model, const Drive& drive, const Points& begin, double booked);
/// The account at the start of the communication step, as a look there shows it.
EnergyAccount account_at_start(const Run& before, const Model& model, const Drive& drive, bool changed);

}  // namespace softffd
