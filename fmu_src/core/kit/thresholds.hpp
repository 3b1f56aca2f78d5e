/// Thresholds of the choice of method and step that several files read, with their unit, what they trade, and what they rest on. One with
/// a single reader stands beside that one, in `namespace thresholds` too.
///
/// "Work" is counted in evaluations of the spring forces, about a microsecond each on 4 x 4 x 4. Trial runs and calibrations are trials of
/// a short stretch whose result is taken back. "Measured" means error against processor time on free vibration, slow loads on stiff bodies,
/// a stiff layer, a light corner, a spinning body and a dropped one; "by experience" on these and on the stability survey's cases.
#pragma once
#include "model/types.hpp"

namespace softffd::thresholds {

// ---- bounds of the frequency, and largest steps ----

/// Internal steps between two looks at the deformation: more looks cost more, fewer come late for a body that stiffens. By experience.
inline constexpr Count look_every = 8;
/// omega h of an implicit step above which the masses are lost in the rounding of the stiffness matrix [1]: (omega h)^2 reaches 1 / 2.2e-16
/// at 7e7.
inline constexpr double stiffest = 2e7;
/// Work that one call may do unless the scene says otherwise, on 4 x 4 x 4: about five seconds.
inline constexpr double most_work = 5e6;
/// Of this the evaluations that a lattice of so many control points may take [1]: larger ones take longer for each.
constexpr double patience(Count points) { return points > 64 ? 64 / double(points) : 1; }
/// Of this a point's contact in one explicit step, measured on a body all of whose points are pressed on a plate.
inline constexpr double contact_work = 1.0 / 8;
/// Of what is left of it, what is kept for the implicit step that ends a stiff body's communication step where the rest is not enough [1].
inline constexpr double passing_over = 0.25;

// ---- obstacles ----

/// Explicit steps in a communication step above which a stiff body's impacts, flights and rests are taken on their own [1]: a flight costs
/// 45 evaluations, an implicit step 150 or more. The same where the whole run has so many explicit steps: measured, boxes of 1e5 N/m and
/// more are then right after several impacts, and twice run explicit steps, which know nothing of the phase at the next one, are not.
inline constexpr double stiff_contact = 200, stiff_contact_of_long_runs = 20, long_contact = 3000;
/// Work of explicit steps through contact in that of plain steps [1]: stretches are run twice, some of them again. By experience.
inline constexpr double doubled_work = 8;

// ---- stiff bodies beside obstacles ----
// Measured on dropped, thrown, spinning, sliding and resting boxes of 1e4 to 1e10 N/m at communication steps of 1 to 50 ms; lengths of
// time are in units of the largest stable explicit step where they are called steps.

/// Part of the tolerance for the error of a window [1].
inline constexpr double window_share = 0.3;
/// Safety and shrinkage of the step of a window, or of a step at rest.
inline constexpr double window_safety = 0.8, window_shrink = 0.1;
/// Share of the vibrations' velocity that the next rebound may feel [1].
inline constexpr double rebound_share = 0.1;
/// Share of the tolerance that positions are taken to err by at least.
inline constexpr double least_error = 0.1;
/// Steps of the first implicit step, which takes up what is left of velocities.
inline constexpr double settling_steps = 200;
/// Bounds of the change of a step at rest, the last after a loss of energy, which is an impact within the step.
inline constexpr double rest_growth = 4, loss_shrink = 0.25;
/// Work that an implicit step with contact may take at least, which is less than so many matrices where these are large, above 8^3 springs;
/// then of what is left to the call at most [1].
inline constexpr double least_implicit_work = 1e4, patient_matrices = 12, patient_share = 0.1;
/// Returns from rest after each of which the next listening is twice as long.
inline constexpr Count most_doubts = 4;

// ---- given steps, fitted steps ----

/// Factor of the tolerance that the summed errors of fixed steps may take by forecast [1]: the forecast takes errors to grow linearly, and
/// by experience those at the end lie below.
inline constexpr double forecast_tolerance = 1.5;

// ---- calibration of fixed steps ----

/// Stretch of a calibration in units of 1 / omega [1]: six periods of the fastest vibrations. Measured in trial runs.
inline constexpr double calibration_window = 40;
/// Work between two trials of any kind at least: less is not worth being precise about.
inline constexpr double shortest_pause = 100;
/// A communication step shorter than this fraction of those of late is no measure for the others [1].
inline constexpr double sliver = 0.2;

// ---- trial runs ----

/// H omega / 2 from which on implicit steps are worth a trial [1]: measured, 10 gave no gain.
inline constexpr double stiff = 25;
/// Work of implicit steps as a fraction of what leapfrog needs: what wins has to win clearly.
inline constexpr double implicit_gain = 0.8;
/// Fraction of the tolerance by which one implicit step may differ from explicit ones that resolve everything [1]. Error estimates of
/// implicit steps do not see what they damp: measured, a light corner under tension ended 77 times the tolerance off without this.
inline constexpr double quiet = 0.3;
/// Twice the damping ratio of the fastest mode, by the bound, from which on it creeps instead of vibrating [1].
inline constexpr double creeping = 2;

// ---- step size controller of the methods with error control ----

/// Safety factor of the next step [1] (Hairer, Norsett, Wanner 1993, section II.4).
inline constexpr double safety = 0.9;
/// Error that is rounding, relative to the size of the positions.
inline constexpr double rounding = 1e-15;

// ---- steps run twice through contact ----

/// Steps of the coarser run in a stretch.
inline constexpr Count stretch_steps = 24;
/// Velocity that a difference may have at the end of a stretch, in its way over the stretch: one that has arisen in the first three
/// quarters counts in full [1].
inline constexpr double way_of_velocity = 4;
/// A stretch is run again if its error is this many times what it may be [1]; a single one may exceed its part.
inline constexpr double too_much = 4;
/// Where contact makes the difference jump, steps are not cut below this fraction of the stable one [1]; of a surface see kit/limits.cpp.
inline constexpr double least_doubled = 1.0 / 1000;
/// Lower bound of the step's change after a stretch [1].
inline constexpr double next_shrink = 0.5;

// ---- retries of a communication step ----

/// Smallest factor of the usual internal step that a gain of energy leads to [1]: by experience what it does not mend has another cause.
inline constexpr double least_step_factor = 1.0 / 32;

}  // namespace softffd::thresholds
