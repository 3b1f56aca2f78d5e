/// Takes a soft body through one communication step: gathers facts, asks for a plan and carries it out. Rolls back where the run comes upon
/// something that the plan did not know.
#pragma once
#include "impacts/impacts.hpp"
#include "kit/integrators.hpp"
#include "kit/thresholds.hpp"
#include "stepping/calibration.hpp"
#include "stepping/damped_steps.hpp"
#include "stepping/lazy.hpp"
#include "stepping/plan.hpp"
#include "stepping/trial_runs.hpp"

namespace softffd {

class Propagator {
 public:
  /// samples: the samples of the surface, if planes meet the surface.
  Propagator(const Lattice& lattice, int planes, int pins, const Samples* samples = nullptr)
      : lattice_(lattice), integrators_(lattice, planes, pins, samples) {}
  /// Runs from the run's time to H later. On failure the run is spoilt, and the caller restores it.
  StepStatus advance(const StepContext& context, double H);
  /// Has every internal step looked at by `points`.
  void follow(const FollowedPoints& points) { integrators_.follow(&points); }
  Budget& budget() { return integrators_.budget(); }
  /// Number of matrices factored since the start; zero as long as no implicit steps are tried.
  Count factorizations() const { return integrators_.factorizations(); }

 private:
  Facts facts(const StepContext& context, double H) const;
  bool may_touch(const StepContext& context, double H);
  void find(Want want, const StepContext& context, double H, Facts& facts);
  StepStatus advance_planned(const StepContext& context, double H);
  bool rolls_back(const StepContext& context, const Plan& plan, StepStatus status, Facts& facts);
  StepStatus carry_out(const StepContext& context, const Plan& plan, double H);
  StepStatus run_by_trials(const StepContext& context, double end);

  Lattice lattice_;
  Integrators integrators_;
  Lazy<Calibrator> calibrator_;
  Lazy<StepDoubling> step_doubling_;
  Lazy<DampedSteps> damped_;
  Lazy<Impacts> impacts_;
  Lazy<TrialRuns> trial_runs_;
  PhysicalState start_;  ///< snapshot of a sub-interval that may have to be rolled back
};

}  // namespace softffd
