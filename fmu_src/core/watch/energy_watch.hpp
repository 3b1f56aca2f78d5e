/// Watch for energy out of nothing. A body has no more energy than it was given, but explicit steps near the stability bound can feed its
/// vibrations without end: by resonance with the springs' nonlinearity, through friction, or where crushed cells stiffen within a step. No
/// error estimate reports it. Damping takes energy, so that its loss need not be known.
///
/// The energy that counts is the one that leapfrog conserves, with the velocities half a step before and after in place of v^2:
///
///      sum m/2 (v - h F/2m)(v + h F/2m) + V  =  kinetic + elastic - h^2/8 sum F^2/m.
///
/// A linear body conserves this energy exactly, while kinetic + elastic varies by (omega h / 2)^2 of itself, at steps near the bound by
/// many times, without harm. The other methods have no such step: for them h counts as 0.
///
/// The flights of a stiff body and the windows between them conserve different energies. Such a body is looked at only in flights, with
/// h = 0, which shows what the changes between the two add. What impacts take is not known then, and hides a gain of the same size.
///
/// Gains are summed from the lowest point on, so that what a body has lost does not hide what it gains. Looks are rare where communication
/// steps are short, because each costs an evaluation of the energy.
#pragma once
#include <algorithm>

#include "body/equations.hpp"
#include "body/model.hpp"
#include "model/run.hpp"

namespace softffd {

/// A gain above this fraction of the largest recent energy is an alarm [1]; smaller gains are errors within the tolerance, by experience.
/// `late_looks` looks count as recent: a body that has come to rest must not gain what was little when it fell.
inline constexpr double most_gain = 0.05;
inline constexpr Count late_looks = 64;

/// Restarts the account at a state that was not reached by motion alone.
void start(EnergyAccount& account, const Equations& equations, const State& state, double work);
/// Accounts for a jump of the outside forces [N] at these spring forces [N]: it is no gain, although the energy that counts jumps too.
void jolt(EnergyAccount& account, const Body& body, const Points& spring, const Points& before, const Points& after);
/// Compares a state with the account. h: size of the steps that led to the state [s]; 0 for methods without staggered velocities.
void look(EnergyAccount& account, const Equations& equations, const State& state, double h, double work);
/// True if the body has gained more than it may. Energies below `noise` [J] are rounding.
inline bool alarm(const EnergyAccount& account, double noise) {
  return !(account.gained <= most_gain * std::max(account.recent, account.earlier) + noise);
}
/// Returns h [s]: the last step of leapfrog and of the central difference, whose velocities stand between positions; otherwise 0.
double staggered_step(const Run& run);
/// Returns the energy that the method has taken until now [J]; negative if gained.
double lost(EnergyAccount account, const Equations& equations, const Run& run);

// ---- the account of a communication step ----

/// If points jump by more than this fraction of the box, the account is restarted [1]. By experience.
inline constexpr double far_jump = 1e-3;

/// Books displacements of points other than by the body's own motion. changed: the material has changed; moved: planes or pins have moved
/// points. Returns the part of the exchange's work that is booked already [J].
double open_account(Run& now, const Run& before, const Model& model, const Drive& drive, bool changed, bool moved);
/// Gives the same with and without energy outputs: reads nothing that only they have counted. begin: positions at the start [m].
void close_account(Run& now, const Model& model, const Drive& drive, const Points& begin, double booked);
/// Returns the account after a look at the start of the communication step.
EnergyAccount account_at_start(const Run& before, const Model& model, const Drive& drive, bool changed);

}  // namespace softffd
