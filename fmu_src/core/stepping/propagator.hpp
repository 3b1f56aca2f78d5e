/// Takes a soft body through one communication step: gathers facts, asks for a plan, carries it out, and goes back where that comes upon
/// what the plan did not know.
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
  /// samples: of the surface, where planes meet it.
  Propagator(const Lattice& lattice, int planes, int pins, const Samples* samples = nullptr)
      : lattice_(lattice), integrators_(lattice, planes, pins, samples) {}
  /// From the run's time to H later. On failure the run is spoilt and the caller restores it.
  StepStatus advance(const StepContext& context, double H);
  /// Has every internal step looked at.
  void follow(const FollowedPoints& points) { integrators_.follow(&points); }
  Budget& budget() { return integrators_.budget(); }
  /// Number of matrices factored since the start: none unless implicit steps are tried.
  Count factorizations() const { return integrators_.factorizations(); }

 private:
  Facts facts(const StepContext& context, double H) const;
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
  PhysicalState start_;  ///< of a stretch that may have to be gone back to
};

}  // namespace softffd
