/// Every threshold of the choice of method and step, with its unit, what it trades, and what it rests on.
///
/// "Work" is counted in evaluations of the spring forces, about a microsecond each on 4 x 4 x 4. Races and calibrations are trials of a
/// short stretch whose result is taken back. "Measured" means error against processor time on free vibration, slow loads on stiff bodies,
/// a stiff layer, a light corner, a spinning body and a dropped one; "by experience" on these and on the stability survey's cases.
#pragma once
#include "model/types.hpp"

namespace softffd::thresholds {

// ---- bounds of the frequency, and largest steps ----

/// Change of an edge's vector relative to its rest length from which on the stability bound is computed anew [1]. Smaller: more bounds to
/// compute; larger: the bound of a state that has gone. By experience the distance that chosen steps keep from the bound covers it.
inline constexpr double deformation = 0.2;
/// The same with a volume stiffness, which grows fast once a corner begins to fold: there no bound holds in every configuration [1].
inline constexpr double deformation_with_volume = 0.05;
/// Internal steps between two looks at the deformation: more looks cost more, fewer come late for a body that stiffens. By experience.
inline constexpr Count look_every = 8;
/// Vibrations of a run, its length times omega, from which on it is long: rkn12 takes a millionth of a vibration's energy per step near the
/// end of its stability interval, which adds up [rad]. The factor by which its steps are shorter then is in its row of traits.cpp.
inline constexpr double long_run = 1e5;
/// (omega h) (spin h) of an implicit step: points go along straight lines, which stretches springs, and the energy of the rotation errs by
/// about its square [1]. By experience on spinning bodies.
inline constexpr double straight_turn = 1e-4;
/// Angle that such a step may turn through, however soft the body [rad]: the torque on turning pins errs as the cube of it.
inline constexpr double straight_angle = 0.005;
/// Angle that a step in the body's own frame may turn through [rad]: the rigid motion is exact, but the loads' directions in the frame are
/// linear in between.
inline constexpr double frame_angle = 1;
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
/// Given steps that can be counted exactly.
inline constexpr double countable = 0x1p53;
/// Work of a communication step by forecast, relative to what is left, at which it is refused before it is done [1]: forecasts err.
inline constexpr double too_long = 1.2;

// ---- obstacles ----

/// Explicit steps in a communication step above which a stiff body's impacts, flights and rests are taken on their own [1]: a flight costs
/// 45 evaluations, an implicit step 150 or more. The same where the whole run has so many explicit steps: measured, boxes of 1e5 N/m and
/// more are then right after several impacts, and twice run explicit steps, which know nothing of the phase at the next one, are not.
inline constexpr double stiff_contact = 200, stiff_contact_of_long_runs = 20, long_contact = 3000;
/// Work that an implicit step may take at least before explicit ones are tried: where a body buckles these are no shorter way.
inline constexpr double buckling_work = 1e6;
/// Work of explicit steps through contact in that of plain steps [1]: stretches are run twice, some of them again. By experience.
inline constexpr double doubled_work = 8;

// ---- stiff bodies beside obstacles ----
// Measured on dropped, thrown, spinning, sliding and resting boxes of 1e4 to 1e10 N/m at communication steps of 1 to 50 ms; lengths of
// time are in units of the largest stable explicit step where they are called steps.

/// Periods of the slowest vibration in the largest time scale of a point [1]: of the uniform lattice of four points a side.
inline constexpr double period_per_time_scale = 26;
/// What is left of a run is taken for at least this share of it [1].
inline constexpr double least_left = 0.02;
/// Steps between two looks; looks at least before it can be called quiet; looks of a window at most.
inline constexpr double look_steps = 24, longest_window = 64;
inline constexpr Count least_looks = 4;
/// Steps that nothing can be touched for when a window ends in a flight, and that a flight takes at least: entering one costs as much.
inline constexpr double worth_flying = 40, shortest_flight = 4;
/// Steps below which a further advance towards a touch is not worth it.
inline constexpr double shortest_advance = 0.25;
/// Work of taking a motion apart into modes, and of a flight.
inline constexpr double entry_work = 15, flight_work = 30;
/// Share of the vibrations' energy by which that of the modes may miss the body's own: beyond, the body is far from its rest shape [1].
inline constexpr double modal_mismatch = 0.01;
/// Steps for which an impact is run with half the step: a contact takes 48 to 120 whatever the stiffness.
inline constexpr double impact_length = 240;
/// Steps of windows that are run once where flights come before and after, in the largest stable ones [1]: leapfrog keeps another energy
/// than the modes do, so that each change from one to the other multiplies a vibration's energy by (2 - a)^2 / (4 (1 - a)) on average, with
/// a = (omega h / 2)^2: 1.10 for the fastest at the largest step, 1.0002 at a quarter of it.
inline constexpr double after_flight = 0.25;
/// Part of the tolerance for the error of a window [1]. Where the phases of the vibrations are lost by this many tolerances impacts may add
/// this share of it: nothing can hold the tolerance then. By so many tolerances of any error windows are run once.
inline constexpr double window_share = 0.3, hopeless = 10, share_of_known = 0.1, lost = 300;
/// The finest run of a window, in steps; times it is run again; safety and shrinkage of its step.
inline constexpr double finest_window = 1.0 / 64, window_safety = 0.8, window_shrink = 0.1;
inline constexpr int most_window_tries = 6;
/// Of the allowed error, what the coarser run may have to let the next windows be run once as coarsely; how many at most. In contact that
/// goes on alone: given to one that had not touched yet it would make the impact a single unchecked run.
inline constexpr double easy = 0.4;
inline constexpr Count longest_window_trust = 32, longest_rest_trust = 128;
/// Periods of the slowest vibration that a difference of velocities lasts at least.
inline constexpr double memory_periods = 10;
/// Cosine of two normals below which obstacles hold a body from two sides [1].
inline constexpr double opposite = -0.5;
/// Share of the vibrations' velocity that the next rebound may feel [1]; of what two runs' vibrations differ by; of the speed of turning in
/// that of approach.
inline constexpr double rebound_share = 0.1, echo_share = 0.3, turning_share = 0.3;
/// The same as the first where a sample of the surface strikes: it stops at once, and with it the mass that moves with it [1].
inline constexpr double struck_share = 0.5;
/// Share of the tolerance that positions are taken to err by at least.
inline constexpr double least_error = 0.1;
/// Largest turn by which an impact is tried for what it makes of errors [rad].
inline constexpr double most_aside = 0.1;
/// Energy that may be damped away, in that of the pressing force along the tolerance [1]: it cannot move the body further.
inline constexpr double quiet_energy = 0.1;
/// Steps of the first implicit step, which takes up what is left of velocities; energy that it may lose, in the same unit; part of the
/// tolerance for its error.
inline constexpr double settling_steps = 200, settling_loss = 3, settling_share = 0.5;
/// Steps from which on implicit ones pay: three cost what these do.
inline constexpr double worth_resting = 400;
/// Part of the tolerance for the error of a step at rest, at most and per share of the run that it takes [1]; what lets the next be taken
/// once; bounds of its change, the last after a loss of energy, which is an impact within the step.
inline constexpr double rest_share = 0.5, rest_rate = 4, easy_rest = 0.2, rest_growth = 4, loss_shrink = 0.25;
/// Of that error, what an event of a contact within the step may leave: beyond, the step ends at the event. What is tried for its time at
/// most, and the part of a step that is tried first where nothing tells when it is; a step also stops short of it by this part at most [1].
inline constexpr double event_share = 0.1, event_shrink = 0.125;
inline constexpr int most_event_tries = 12;
/// Returns from rest after each of which the next listening is twice as long.
inline constexpr Count most_doubts = 4;
/// Gap relative to the box up to which what rings counts as touching, for whether the body falls over [1]; logarithm of the largest growth.
inline constexpr double snug = 1e-4, longest_growth = 20;
/// Gap relative to the box at which a body at rest has lifted off; gap that is closed after the body is moved as a whole [1].
inline constexpr double lifted = 1e-9, snapped = 1e-13;
/// Work that an implicit step at rest may take at least.
inline constexpr double least_implicit_work = 1e4;

// ---- damped bodies beside obstacles ----

/// Explicit steps in what is left of a communication step, from which on a pinned body with internal damping takes implicit ones where no
/// race has found any [1].
inline constexpr double stiff_damping = 500;
/// What an implicit step takes that pays in the place of explicit ones: factors, it being run twice, and solutions with each.
inline constexpr double damped_runs = 3, damped_solutions = 10;
/// First step, and explicit steps before implicit ones are tried again, in the shortest that pay; how often the latter get twice as many.
inline constexpr double first_damped = 2, damped_turn = 2;
inline constexpr Count most_damped_doubts = 6;
/// Errors of all steps in the tolerance; of what is left of that, the error of a step, or of the tolerance per share of the time that
/// errors are remembered for, and at most [1].
inline constexpr double damped_sum = 0.5, damped_share = 0.2, damped_rate = 1, damped_most = 0.3;
/// Of the largest force, the error of the mean force of a communication step, or of what moves a point by the tolerance [1].
inline constexpr double force_share = 0.008, moving_force = 0.01;
/// Radians of a vibration that a step may be long and yet differ visibly from two of half its length [rad].
inline constexpr double passed_over = 10;
/// Of the first step in a communication step, after that of the one before, which was cut [1].
inline constexpr double opening_growth = 2;
/// Error of a step in the bend of its velocities: at least, by how much it may have grown since the last step that was run twice for the
/// next to be run once, and what is added for safety [1]; how many of these at most.
inline constexpr double least_share = 0.02, shares_alike = 2, share_safety = 1.5;
inline constexpr Count longest_damped_trust = 32;
/// Of what is allowed, the way of contacts that stop, turn round or begin to slide in a step, from which on they count [1].
inline constexpr double slight_slip = 0.01;
/// Of the tolerance, by which the equations of a stage may be solved wrong.
inline constexpr double solved = 1e-4;
/// Shortest step in the largest explicit one, where there are no explicit steps to take over [1].
inline constexpr double shortest_damped = 0.05;

// ---- given steps, fitted steps ----

/// A step is made longer again only by this factor or more [1]: every change costs a method its coefficients for the step.
inline constexpr double regrowth = 1.25;
/// Factor of the tolerance that the summed errors of fixed steps may take by forecast [1]: the forecast takes errors to grow linearly, and
/// by experience those at the end lie below.
inline constexpr double forecast_tolerance = 1.5;
/// The same of contact of a surface, whose stretches err alike: rolling does.
inline constexpr double surface_tolerance = 0.6;
/// The same of contact of a body with internal damping, whose errors add to those of implicit steps.
inline constexpr double damped_tolerance = 0.5;

// ---- calibration of fixed steps ----

/// Stretch of a calibration in units of 1 / omega [1]: six periods of the fastest vibrations. Measured in races.
inline constexpr double calibration_window = 40;
/// Steps of the coarser run at most: leapfrog, bm4.
inline constexpr Count calibration_steps = 40, calibration_steps_bm4 = 16;
/// Work between two calibrations, in multiples of a calibration's own [1]: so they cost at most a tenth of a run; and after a jolt.
inline constexpr double calibration_pause = 10, calibration_pause_after_jolt = 3;
/// Work between two trials of any kind at least: less is not worth being precise about.
inline constexpr double shortest_pause = 100;
/// A factor of the step from which on a calibration is good enough, its extrapolation being that of the method's order [1].
inline constexpr double calibrated = 0.35;
/// Bounds of the factor by which one calibration may change the step [1].
inline constexpr double calibration_shrink = 1e-4, calibration_growth = 4;
/// The same after a trial without a finite result [1].
inline constexpr double after_failed_trial = 0.1;
/// Rounds of a calibration: within a run; in a race the first of leapfrog, of bm4, the others of leapfrog.
inline constexpr int calibration_rounds = 4, race_rounds = 1, race_rounds_bm4 = 2, race_rounds_left = 3;
/// A communication step shorter than this fraction of those of late is no measure for the others [1].
inline constexpr double sliver = 0.2;
/// What is left per communication step of the length that is remembered of those of late [1].
inline constexpr double usual_decay = 0.8;

// ---- races ----

/// Work between two races, in multiples of a race's own, and its limit while the winner stays [1]; after a jolt. Measured before the pause
/// was bound to their work: races took 5 to 30 % of a run of a second. Now a tenth at most, and less while the winner stays.
inline constexpr double race_pause = 10, longest_race_pause = 160, race_pause_after_jolt = 3;
/// A challenger has to need this much less work than the last winner [1]: measured without it winners changed up to 27 times in a run.
inline constexpr double challenge = 1.2;
/// H omega / 2 from which on implicit steps are worth a trial [1]: measured, 10 gave no gain.
inline constexpr double stiff = 25;
/// The same for a body that turns freely, whose frame takes work too. By experience.
inline constexpr double stiff_turning = 100;
/// Work that a trial of implicit steps may take, and as a fraction of what leapfrog needs: one that wins has to win clearly.
inline constexpr double longest_trial = 20'000, implicit_gain = 0.8;
/// Fraction of the tolerance by which one implicit step may differ from explicit ones that resolve everything [1]. Error estimates of
/// implicit steps do not see what they damp: measured, a light corner under tension ended 77 times the tolerance off without this.
inline constexpr double quiet = 0.3;
/// Twice the damping ratio of the fastest mode, by the bound, from which on it creeps instead of vibrating [1]; by how many steps in the
/// place of one implicit one that is seen [1].
inline constexpr double creeping = 2;
inline constexpr Count creep_parts = 16;
/// Vibration in units of the tolerance above which implicit steps must not pass over it [1]: what is compared is a bound. By experience.
inline constexpr double loud = 3;
/// Vibrations with time scales above this many implicit steps are resolved by their error control [1]. By experience.
inline constexpr double resolved = 8;
/// Leapfrog's work in units of what stability asks for, up to which nothing else is tried [1]: per evaluation of the forces nothing is
/// stable for as long as leapfrog (bm4 has a third of its interval), so that the trials would cost more than they find.
inline constexpr double enough = 1.7;
/// Stretch of the trial of a method with error control in units of 1 / omega [1]: some steps, until it has found their size.
inline constexpr double controlled_window = 30;
/// A winner that needs so many times the forecast runs again [1].
inline constexpr double overrun = 2.5;

// ---- step size controller of the methods with error control ----

/// Safety factor of the next step; bounds of its change; growth where the error is zero [1] (Hairer, Norsett, Wanner 1993, section II.4).
inline constexpr double safety = 0.9, shrink = 0.1, growth = 6, growth_without_error = 5;
/// After a rejected step the next is at most this much of it [1].
inline constexpr double after_rejection = 0.9;
/// The same where an old factor may be at fault: it is made anew, at a step between these [1].
inline constexpr double old_factor_shrink = 0.5, old_factor_keep = 0.95;
/// Between these the step of an implicit method stays, and with it the factor of its matrix [1]: measured, a kept factor is worth a
/// factor of 1.5 to 2.4.
inline constexpr double keep_below = 0.95, keep_above = 1.5;
/// A step that turns the body by more than twice the limit is halved [1].
inline constexpr double turned_too_far = 2, turned_shrink = 0.5;
/// A step that the communication point has cut to less than this fraction says nothing about the next [1].
inline constexpr double cut_short = 0.2;
/// First step in units of 1 / omega [1].
inline constexpr double first_step = 3;
/// Error that is rounding, relative to the size of the positions; shortest step relative to the times [1].
inline constexpr double rounding = 1e-15, shortest_step = 1e-14;

// ---- steps run twice through contact ----

/// Steps of the coarser run in a stretch.
inline constexpr Count stretch_steps = 24;
/// A stretch is run again if its error is this many times what it may be [1]; a single one may exceed its part.
inline constexpr double too_much = 4;
/// Where contact makes the difference jump, steps are not cut below this fraction of the stable one [1].
inline constexpr double least_doubled = 1.0 / 1000;
/// Times that a stretch is run again.
inline constexpr int most_reruns = 4;
/// Stretches that may be run once after a success, at least and at most [1]. By experience on dropped and sliding bodies, as all of these.
inline constexpr double shortest_trust = 8, longest_trust = 128;
/// Of the allowed error, what the coarser run may have for that, and before it is trusted at all [1]: a change of the step may make a
/// vibration larger by a third, and one that lost the trust by that would never come to rest.
inline constexpr double trusted = 0.5, trusted_at_first = 0.125;
/// Bounds of the step's change after a stretch, and before it is run again; growth where the error is zero [1].
inline constexpr double next_shrink = 0.5, next_growth = 1.5, rerun_shrink = 0.2, rerun_growth = 0.7, doubled_growth = 2;

// ---- retries of a communication step ----

/// How often the internal step of a communication step without a finite result is halved: by experience on crushed and on collapsing bodies
/// what five halvings do not mend more do not.
inline constexpr int most_halvings = 5;
/// Smallest factor of the usual internal step that a gain of energy leads to [1]: by experience what it does not mend has another cause.
inline constexpr double least_step_factor = 1.0 / 32;
/// Of the energy gained, what may be left with smaller steps if it was these that were at fault [1].
inline constexpr double mended = 0.25;

// ---- what is seen from outside ----

/// Change of the outside forces relative to their size, between two communication steps, that is a jolt [1].
inline constexpr double jolt = 0.01;

}  // namespace softffd::thresholds
