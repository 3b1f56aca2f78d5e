/// How long an internal step may be at a state: by stability, by damping, by the turning of the body. And what a difference between two
/// runs will have grown to at the end.
#pragma once
#include "kit/step_context.hpp"
#include "methods/traits.hpp"

namespace softffd {

/// Upper bound of omega at the present state [rad/s]; computed anew only when the body has deformed since (run.control.bound).
double bound(const StepContext& context);
/// Of the rate of damping [1/s], renewed with it.
double damping_bound(const StepContext& context);
bool deformed_since_bound(const StepContext& context);
/// Largest step of a method [s]: that a user may give, or that is chosen.
double step_limit(const StepContext& context, Method method, bool given);
/// Steps of leapfrog through contact are not cut below this, where its largest is `limit` [s].
double shortest_in_contact(const StepContext& context, double limit);
/// Longest implicit step of a body that turns as (x, v) does [s]. A step takes points along straight lines; what that stretches the springs
/// throws them back with (omega h) times the speed of turning, so that the energy of the rotation errs by about (omega h spin h)^2. Where
/// pins turn, the forces on them do.
double turning_limit(const StepContext& context, const Points& x, const Points& v);
/// What states a and b, after the same stretch of time [s] from one state, will differ by at the end of the run, if the difference keeps
/// growing until damping forgets it [m]; infinite where one is not finite.
double growing(const StepContext& context, const State& a, const State& b, double stretch);
/// The same where differences of stretches do not point the same way, as after impacts of vertices: their squares add up, and each has by
/// then spread over the body; those of free bodies add up. A velocity counts only as far as it has moved its point: where a vertex has
/// landed in one of the runs, it will in the other within a step.
double scattered(const StepContext& context, const State& a, const State& b, double stretch);

}  // namespace softffd
