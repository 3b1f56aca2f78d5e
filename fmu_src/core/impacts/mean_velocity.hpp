/// The rigid part of an implicit step. Backward Euler moves a body by its velocity at the end of the step; here the rigid motion goes by
/// the mean of the velocities at both ends, so that sliding with constant friction is exact in steps of any length.
#pragma once
#include "kit/step_context.hpp"

namespace softffd {

/// Moves the centre and turns the attitude by the mean of the velocities at both ends; the deformation stays. along: only as far as no gap
/// to a touched obstacle changes, and not at all if a touched obstacle is a solid.
void follow_mean_velocity(const StepContext& context, const PhysicalState& before, double h, bool along);

}  // namespace softffd
