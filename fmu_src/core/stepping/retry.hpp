/// Which results of a communication step stand, and which are tried again with smaller steps. `attempt(step_factor)` does the communication
/// step from the run as it is, with that factor of the usual internal step; the snapshot takes a trial back to its beginning.
#pragma once
#include "kit/budget.hpp"
#include "kit/snapshot.hpp"
#include "kit/thresholds.hpp"
#include "model/run.hpp"

namespace softffd {

namespace thresholds {

/// How often the internal step of a communication step without a finite result is halved: by experience on crushed and on collapsing
/// bodies, more halvings do not mend what five do not.
inline constexpr int most_halvings = 5;
/// Smaller steps have mended a gain of energy if at most this fraction of the gain is left [1].
inline constexpr double mended = 0.25;

}  // namespace thresholds

/// Tries smaller internal steps after the state went astray, as long as all trials together have taken no more than half of `most`, the
/// call's work. divided: is multiplied by the factor by which the step is divided.
template <class Attempt>
StepStatus retry_divided(Run& run, Snapshot<Run>& snapshot, double most, double step_factor, StepStatus failure, double& divided,
                         Attempt&& attempt) {
  const double begun = snapshot.before().control.work;
  double work = run.control.work - begun;
  for (int halvings = 0; halvings < thresholds::most_halvings && 2 * work <= most; ++halvings) {
    step_factor /= 2;
    divided *= 2;
    snapshot.rollback();
    const StepStatus status = attempt(step_factor);
    if (status != StepStatus::not_finite && status != StepStatus::too_much_work) return status;
    work += run.control.work - begun;
  }
  return failure;
}

/// The body has gained energy at automatic steps: takes smaller steps from here on, and in this communication step already if the gain came
/// from it. If smaller steps do not help, the communication step is repeated with the usual steps and stands. at_start: the energy account
/// at the beginning, as a check there shows it. most: the call's work, of which enough is reserved to repeat the first attempt.
template <class Attempt>
StepStatus retry_gained(Run& run, Snapshot<Run>& snapshot, Budget& budget, double most, EnergyAccount at_start, Attempt&& attempt) {
  const EnergyAccount& before = snapshot.before().energy;
  const double gained = run.energy.gained, gained_before = at_start.gained, begun = snapshot.before().control.work;
  double work = run.control.work - begun, step_factor = before.step_factor;
  at_start.gained = at_start.due = 0;
  Budget::Reserve again(budget, (most - budget.left()) / (1 - thresholds::passing_over));
  bool tried = false;
  while (step_factor > thresholds::least_step_factor && 2 * work <= most && !budget.spent()) {
    tried = true;
    step_factor /= 2;
    snapshot.rollback();
    run.energy = at_start;
    if (attempt(step_factor) != StepStatus::ok) break;
    work += run.control.work - begun;
    run.energy.step_factor = step_factor;
    const bool mended = run.energy.gained <= thresholds::mended * (gained - gained_before);
    if (mended || gained_before > (1 - thresholds::mended) * gained) return StepStatus::ok;
  }
  again.release();
  if (tried) snapshot.rollback();
  run.energy.hopeless = true;
  return tried ? attempt(before.step_factor) : StepStatus::ok;
}

}  // namespace softffd
