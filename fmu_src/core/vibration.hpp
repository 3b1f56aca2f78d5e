/// How far the springs' own motion moves control points: a bound, by experience, of what an error in the phase of vibrations can amount to,
/// however long it has been adding up.
#pragma once
#include "equations.hpp"
#include "integrator.hpp"

namespace softffd {

/// Twice the largest of: extension of a spring, what its rate of extension and what the present accelerations carry in 2.5 time scales
/// [m]. Rigid motion counts nothing but its accelerations. time_scale: (3 * points) [s].
double vibration(const Equations& equations, const State& state, const Scalars& time_scale);

}  // namespace softffd
