/// Which results of a communication step stand, and which are tried again with smaller steps. `attempt(step_factor)` does the communication
/// step from the run as it is, with that factor of the usual internal step; the trial goes back to its beginning.
#pragma once
#include "kit/thresholds.hpp"
#include "kit/trial.hpp"
#include "model/run.hpp"

namespace softffd {

/// Of all trials of a communication step together.
inline double most_retry_work(const Run& run) { return thresholds::patience(run.path.motion.x.rows()) * thresholds::retry_work; }

/// The state went astray: tries smaller internal steps, as long as that is not too much work. divided: by how much.
template <class Attempt>
StepStatus retry_divided(Run& run, Trial<Run>& trial, double step_factor, StepStatus failure, double& divided, Attempt&& attempt) {
  const double begun = trial.before().course.work;
  double work = run.course.work - begun;
  const double most = most_retry_work(run);
  for (int halvings = 0; halvings < thresholds::most_halvings && 2 * work <= most; ++halvings) {
    step_factor /= 2;
    divided *= 2;
    trial.back();
    const StepStatus status = attempt(step_factor);
    if (status != StepStatus::not_finite && status != StepStatus::too_many_steps) return status;
    work += run.course.work - begun;
  }
  return failure;
}

/// The body has gained energy at automatic steps: smaller ones from here on, and in this step already if it was the one. If they do not
/// help the step stands. at_start: the energy account at the beginning, as a look there shows it.
template <class Attempt>
StepStatus retry_gained(Run& run, Trial<Run>& trial, EnergyAccount at_start, Attempt&& attempt) {
  const EnergyAccount& before = trial.before().energy;
  const double gained = run.energy.gained, gained_before = at_start.gained, begun = trial.before().course.work;
  const double most = most_retry_work(run);
  double work = run.course.work - begun, step_factor = before.step_factor;
  at_start.gained = at_start.due = 0;
  while (step_factor > thresholds::least_step_factor && 2 * work <= most) {
    step_factor /= 2;
    trial.back();
    run.energy = at_start;
    if (attempt(step_factor) != StepStatus::ok) break;
    work += run.course.work - begun;
    run.energy.step_factor = step_factor;
    const bool mended = run.energy.gained <= thresholds::mended * (gained - gained_before);
    if (mended || gained_before > (1 - thresholds::mended) * gained) return StepStatus::ok;
  }
  trial.back();
  run.energy.hopeless = true;
  return attempt(before.step_factor);
}

}  // namespace softffd
