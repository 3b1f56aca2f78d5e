/// The time of the means that outputs show after a communication step: reactions, centres of pressure, sensors and accelerations.
///
/// In a communication step of length H a force f moves a point of mass m by f/m H^2. If rounding of the position hides that motion, contact
/// with an obstacle does not notice that the point approaches, and gives it no impulse. The point keeps the velocity f/m H. The velocities
/// of several such steps add up until one step moves the point by more than rounding, and contact then gives the impulse of all of these
/// steps at once. The mean over one step would be 0, or many times the force.
///
/// Such a step therefore waits for its means: outputs show the means of the step before, and impulses add up. `Run::hidden` adds up the
/// momentum that forces gave the points meanwhile; divided by the present forces it is the time of the impulses. The mean over that time is
/// shown when contact has given several impulses in it: after a step that gave one, so that no impulse is due. Forces give no more than
/// that momentum, and rounding of positions changes velocities by so much within one step: if the impulses differ from the means of the
/// step before by more, such as at an impact, the step shows them at once, with its own length.
///
/// Impulses of pins are never hidden. They add up over a time that rounding of the clock does not change noticeably.
#pragma once
#include "body/equations.hpp"
#include "model/run.hpp"

namespace softffd {

/// Forces on free bodies and on the points that no pin holds, at the start of a communication step.
struct HiddenForces {
  double sum = 0;   ///< sum of their sizes [N]
  double most = 0;  ///< impulse that they and rounding may give by the end of the step, with all that waits [N s]
  double way = -1;  ///< how far they move any point in the step, with all velocities that wait, in units of rounding [1]; negative: far
};

/// Returns the forces that rounding may hide in a communication step of length H [s].
HiddenForces hidden_forces(const Equations& equations, const Run& run, double H);

/// Returns the time of the means that a communication step of length H shows at its end [s]; 0 if it waits. before: the run at its start.
/// first: it is the first step.
double time_of_means(const HiddenForces& forces, const Run& before, bool first, double H, Run& run);

/// Takes the means of pins after a communication step of length H [s], unless they wait.
void take_means_of_pins(double H, Run& run);

}  // namespace softffd
