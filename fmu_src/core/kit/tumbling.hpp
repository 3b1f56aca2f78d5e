/// How the turning of a free rigid body multiplies an error of its attitude, which decides how accurate the steps of a tumbling body must
/// be. A body that turns about its middle axis of inertia flips over, and the time of the next flip depends on tiny errors.
///
/// Without torque the angular momentum L keeps its value in the world. For a body of inertia I and spin w = I^-1 L, in its own axes, an
/// error f of the attitude obeys the variational equation
///
///      f' = -w x f + I^-1 (L x f),      L' = L x w,
///
/// so that an error at time s has become N(s) f at the end of the run. Other errors add nothing to this: an error of L across L is an error
/// of the attitude and a turn of the whole motion, and an error of the size of L is an error of the time, which grows linearly. The factor
/// of growth is the norm of N(s), and what a run of equal errors feels is its mean over s.
///
/// Both equations are integrated by exact turns about one principal axis after the other (McLachlan 1993, Explicit Lie-Poisson
/// integration): the energy, which decides on flips, does not drift. L is taken to the end of the run, then back together with N.
///
/// Explicit steps without damping do not feel this growth. They are symplectic and conserve L, so that their motion is that of a slightly
/// different body, whose energy is as constant: measured, an error that would grow by 1e7 grows by less than 100.
#pragma once
#include "body/rigid_motion.hpp"
#include "kit/step_context.hpp"

namespace softffd {

/// Growth of errors in a motion without torque.
struct Growth {
  double mean = 1;                                    ///< of equal errors at all times [1]; at least 1
  double largest = 1;                                 ///< of an error at the worst time [1]; at least 1
  Eigen::Matrix3d now = Eigen::Matrix3d::Identity();  ///< what an error of the attitude at the start becomes; of a vector in world axes
};
/// Returns the growth in the rest of a motion that lasts for `time` [s].
Growth tumbling_growth(const RigidMotion& motion, double time);
/// Returns its mean from the present state to the end of the run, kept in run.control for a while. 1 for a body that something holds, that
/// an obstacle may stop, or that hardly turns.
double tumbling_growth(const StepContext& context);
/// Returns the growth from a state of the present time to the end of the run; none for a body whose mean growth is 1.
Growth growth_from(const StepContext& context, const State& state);
/// Returns what the difference of two attitudes of the body, now, will have grown to at the end of the run [m].
double turned_apart(const StepContext& context, const State& state, const Points& other);
/// Returns the same for the difference of the rigid motions of two states that were reached from one state, where each sub-interval adds as
/// much [m]; 0 for a body without damping, whose explicit steps do not feel the growth.
double drifted_apart(const StepContext& context, const State& a, const State& b);

}  // namespace softffd
