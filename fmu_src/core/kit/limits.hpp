/// Largest internal step at a state: by stability, by damping and by the rotation of the body. Also the final error that a difference
/// between two runs will have grown to.
#pragma once
#include "kit/step_context.hpp"
#include "methods/traits.hpp"

namespace softffd {

/// Upper bound of omega at the present state [rad/s]; recomputed only if the body has deformed since the last time (run.control.bound).
double bound(const StepContext& context);
/// Upper bound of the rate of damping [1/s], renewed together with `bound`.
double damping_bound(const StepContext& context);
bool deformed_since_bound(const StepContext& context);
/// Largest step of a method [s]: the largest that a user may give (given), or the largest that is chosen automatically.
double step_limit(const StepContext& context, Method method, bool given);
/// Shortest step that leapfrog's steps through contact are cut to, where the largest step is `limit` [s].
double shortest_in_contact(const StepContext& context, double limit);
/// Longest implicit step for a body that turns as (x, v) does [s]. A step takes points along straight lines, which stretches the springs.
/// The springs throw the points back with (omega h) times the speed of turning, so that the energy of the rotation errs by about (omega h
/// spin h)^2. Where pins turn, the forces on the pins err likewise.
double turning_limit(const StepContext& context, const Points& x, const Points& v);
/// Difference of positions that is rounding [m].
double position_rounding(const StepContext& context);
/// Final error by rounding alone [m]: that of the positions, and that of the velocities by forces at rounded positions.
double rounding_by_end(const StepContext& context);
/// Final error of states a and b, which were reached from one state over the same sub-interval `stretch` [s], if their difference keeps
/// growing until damping forgets it [m]; infinite if a difference is not finite. Rounding of positions does not keep growing.
double growing(const StepContext& context, const State& a, const State& b, double stretch);
/// The same where differences of sub-intervals do not point the same way, as after impacts of vertices: their squares add up, and each has
/// spread over the body by the end. Differences of free bodies add up. A velocity counts only as far as it has moved its point: a vertex
/// that has landed in one run will land in the other within a step.
double scattered(const StepContext& context, const State& a, const State& b, double stretch);

}  // namespace softffd
