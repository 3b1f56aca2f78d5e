/// Supporting half-spaces that stand for solids during a communication step. To every method, a solid that is met with a flat face, or
/// not at all, is then the same as a plane.
///
///            n ^    samples
///      ________|___.__._____     The supporting half-space with normal n contains the whole solid, which is convex. Samples in front of
///           | solid  |           the half-space are in front of the solid. If the samples that press lie on the solid, the forces are
///           |________|           those of the solid. Methods check the samples that press: if one lies beside the solid, they report
///                                StepStatus::beside_solid, and the communication step is run once more with the solids themselves.
///
/// Which half-space may stand is a forecast from the speeds and forces at the beginning. The forecast saves running many steps twice.
#pragma once
#include "body/equations.hpp"
#include "model/state.hpp"

namespace softffd {

/// Finds half-spaces that may stand for the solids of `around` during H from now, up to the first solid for which none may.
void let_half_spaces_stand(const Body& body, Drive& around, const State& state, double H);
/// Removes the half-spaces: all solids are met as themselves.
inline void meet_solids(Drive& around) {
  for (Plane& plane : around.planes) plane.facing.setZero();
}

}  // namespace softffd
