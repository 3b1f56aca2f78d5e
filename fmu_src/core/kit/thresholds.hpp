/// Thresholds of the choice of method and step that several files read, with their unit, what they trade, and what they rest on. A
/// threshold with a single reader stands beside that reader, in `namespace thresholds` too.
///
/// "Work" is counted in evaluations of the spring forces, about a microsecond each on 4 x 4 x 4. Trial runs and calibrations run a short
/// sub-interval and roll it back. "Measured" means error against processor time on free vibration, slow loads on stiff bodies, a stiff
/// layer, a light corner, a spinning body and a dropped one; "by experience" means on these and on the stability survey's cases.
#pragma once
#include "model/types.hpp"

namespace softffd::thresholds {

// ---- bounds of the frequency, and largest steps ----

/// Internal steps between two checks of the deformation: more checks cost more, fewer come late for a body that stiffens. By experience.
inline constexpr Count look_every = 8;
/// Largest omega h of an implicit step [1]: above it the masses are lost in the rounding of the stiffness matrix. (omega h)^2 reaches 1 /
/// 2.2e-16 at 7e7.
inline constexpr double stiffest = 2e7;
/// Work that one call may do unless the scene sets another limit, on 4 x 4 x 4: about five seconds.
inline constexpr double most_work = 5e6;
/// Fraction of that work that is allowed on a lattice of so many control points [1]: an evaluation takes longer on larger lattices.
constexpr double patience(Count points) { return points > 64 ? 64 / double(points) : 1; }
/// Work of a point's contact in one explicit step, times `patience`; measured on a body all of whose points are pressed on a plate.
inline constexpr double contact_work = 1.0 / 8;
/// Fraction of the rest of the budget that is kept for an implicit step, which ends a stiff body's communication step if need be [1].
inline constexpr double passing_over = 0.25;

// ---- obstacles ----

/// A stiff body's impacts, flights and rests are taken on their own above this number of explicit steps in a communication step [1]: a
/// flight costs 45 evaluations, an implicit step 150 or more. The second number holds if the whole run has more than long_contact explicit
/// steps: measured, boxes of 1e5 N/m and more are then right after several impacts. Explicit steps that are run twice are not, because they
/// know nothing of the phase at the next impact.
inline constexpr double stiff_contact = 200, stiff_contact_of_long_runs = 20, long_contact = 3000;
/// Work of explicit steps through contact relative to plain steps [1]: sub-intervals are run twice, some of them again. By experience.
inline constexpr double doubled_work = 8;

// ---- stiff bodies beside obstacles ----
// Measured on dropped, thrown, spinning, sliding and resting boxes of 1e4 to 1e10 N/m at communication steps of 1 to 50 ms. Times that are
// called steps are in units of the largest stable explicit step.

/// Fraction of the tolerance that the error of one window may take [1].
inline constexpr double window_fraction = 0.3;
/// Safety factor and smallest factor of the step after a window, or after a step at rest [1].
inline constexpr double window_safety = 0.8, window_shrink = 0.1;
/// Fraction of the vibrations' velocity that the next rebound may feel [1].
inline constexpr double rebound_fraction = 0.1;
/// Positions are taken to err by at least this fraction of the tolerance [1].
inline constexpr double least_error = 0.1;
/// Length of the first implicit step at rest, in steps. This step takes up what is left of velocities.
inline constexpr double settling_steps = 200;
/// Largest factor of a step at rest [1]: in general, and after a loss of energy, which is an impact within the step.
inline constexpr double rest_growth = 4, loss_shrink = 0.25;
/// An implicit step with contact may take at least the first of these works. Where matrices are large, above 8^3 springs, so many matrices
/// are more, and the step may take those, up to a fraction of what is left to the call [1].
inline constexpr double least_implicit_work = 1e4, patient_matrices = 12, patient_fraction = 0.1;
/// Number of returns from rest up to which each return makes the next listening twice as long.
inline constexpr Count most_doubts = 4;

// ---- given steps, fitted steps ----

/// The summed errors of fixed steps may be this multiple of the tolerance by forecast [1]: the forecast takes errors to grow linearly, and
/// by experience the errors at the end lie below.
inline constexpr double forecast_tolerance = 1.5;

// ---- calibration of fixed steps ----

/// Length of the sub-interval of a calibration in units of 1 / omega [1]: six periods of the fastest vibrations. Measured in trial runs.
inline constexpr double calibration_window = 40;
/// Least work between two trials of any kind: a smaller amount of work is not worth being precise about.
inline constexpr double shortest_pause = 100;
/// A communication step shorter than this fraction of the recent ones is no measure for the others [1].
inline constexpr double sliver = 0.2;

// ---- trial runs ----

/// Implicit steps are worth a trial above this H omega / 2 [1]: measured, 10 gave no gain.
inline constexpr double stiff = 25;
/// Implicit steps win if they need at most this fraction of leapfrog's work [1]: they have to win clearly.
inline constexpr double implicit_gain = 0.8;
/// One implicit step may differ by this fraction of the tolerance from explicit steps that resolve everything [1]. Error estimates of
/// implicit steps do not see what the steps damp: measured, a light corner under tension ended 77 times the tolerance off without it.
inline constexpr double quiet = 0.3;
/// The fastest mode creeps instead of vibrating if twice its damping ratio, by the bound, is at least this [1].
inline constexpr double creeping = 2;

// ---- step size controller of the methods with error control ----

/// Safety factor of the next step [1] (Hairer, Norsett, Wanner 1993, section II.4).
inline constexpr double safety = 0.9;
/// Errors of this size relative to the positions are rounding [1].
inline constexpr double rounding = 1e-15;

// ---- steps run twice through contact ----

/// Steps of the coarser run in a sub-interval.
inline constexpr Count stretch_steps = 24;
/// A difference of velocities at the end of a sub-interval counts up to this multiple of the difference of positions over the length of the
/// sub-interval [1]: a velocity that has arisen in the first three quarters counts in full.
inline constexpr double way_of_velocity = 4;
/// A sub-interval is run again if its error is above this multiple of the allowed error [1]; a single sub-interval may exceed its part.
inline constexpr double too_much = 4;
/// Where contact makes the difference jump, steps are not cut below this fraction of the stable step [1]; for a surface see kit/limits.cpp.
inline constexpr double least_doubled = 1.0 / 1000;
/// Smallest factor of the step after a sub-interval [1].
inline constexpr double next_shrink = 0.5;

// ---- retries of a communication step ----

/// Smallest factor of the usual internal step after a gain of energy [1]: by experience, a gain that remains then has another cause.
inline constexpr double least_step_factor = 1.0 / 32;

}  // namespace softffd::thresholds
