/// Half-spaces that stand for solids during a communication step: a solid that is met by a flat face, or not at all, is then what a plane
/// is, to every method.
///
///            n ^    samples
///      ________|___.__._____     The half-space that touches a solid along n holds all of it, for it is convex. Samples in front of the
///           | solid  |           half-space are in front of the solid, and where those that press lie on the solid, its forces are the
///           |________|           solid's. Methods look at what presses; beside the solid they report StepStatus::beside_solid, and the
///                                communication step is taken once more, in which solids are met as themselves.
///
/// Which half-space may stand is a forecast, by the speeds and forces at the beginning, that saves taking many steps twice.
#pragma once
#include "body/equations.hpp"
#include "model/state.hpp"

namespace softffd {

/// Finds half-spaces for the solids of `around` that one may stand for until H from now: all up to the first that none can.
void let_half_spaces_stand(const Body& body, Drive& around, const State& state, double H);
/// All solids are met as themselves.
inline void meet_solids(Drive& around) {
  for (Plane& plane : around.planes) plane.facing.setZero();
}

}  // namespace softffd
