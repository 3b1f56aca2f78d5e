/// Trial runs: each candidate that could win is tried on a short sub-interval, or on the communication step itself, and the result is
/// written to run.control.trials. The facts are the works; plan.hpp decides. All trial runs are rolled back, except implicit steps that
/// win: they have done what is left of the communication step already.
#pragma once
#include "kit/integrators.hpp"
#include "stepping/calibration.hpp"
#include "stepping/plan.hpp"

namespace softffd {

class TrialRuns {
 public:
  explicit TrialRuns(const Run& run) : start_(run), fine_(run.physical.motion) {}

  /// True if trial runs are due for what is left [s] of the communication step.
  static bool due(const StepContext& context, double H);
  void run(Integrators& integrators, Calibrator& calibrator, const StepContext& context, double H);

 private:
  void try_implicit(Integrators& integrators, const StepContext& context, double H, double others, Candidates& candidates);
  bool fast_modes_are_quiet(Integrators& integrators, const StepContext& context, Method method, double H);
  double implicit_work(Integrators& integrators, const StepContext& context, Method method, double H, double budget);
  double controlled_work(Integrators& integrators, const StepContext& context, Method method, double H);

  Run start_;
  State fine_;
  double spent_ = 0;  ///< work of the current trial runs
};

}  // namespace softffd
