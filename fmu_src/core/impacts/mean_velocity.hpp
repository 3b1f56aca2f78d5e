/// The rigid part of an implicit step: backward Euler moves a body by its velocity at the end of the step, here it goes by the mean of
/// those at both ends, so that sliding with constant friction is exact in steps of any length.
#pragma once
#include "kit/step_context.hpp"

namespace softffd {

/// The centre moves, and the attitude turns, by the mean of the velocities at both ends; the deformation stays. along: only so far as no
/// gap of what was touched changes, and where that has curved sides not at all.
void follow_mean_velocity(const StepContext& context, const PhysicalState& before, double h, bool along);

}  // namespace softffd
