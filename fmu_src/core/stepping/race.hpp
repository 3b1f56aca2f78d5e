/// A race: each candidate that could win is tried on a short stretch, or on the communication step itself, and what that took is written to
/// run.course.race. Its facts are the works; plan.hpp decides. All trials are taken back, but for implicit steps that win: they have done
/// what is left of the communication step already.
#pragma once
#include "kit/integrators.hpp"
#include "stepping/calibration.hpp"
#include "stepping/plan.hpp"

namespace softffd {

class Race {
 public:
  explicit Race(const Run& run) : start_(run), fine_(run.path.motion) {}

  /// Is there a race to be run for what is left [s] of the communication step?
  static bool due(const Job& job, double H);
  void run(Integrators& integrators, Calibrator& calibrator, const Job& job, double H);

 private:
  void try_implicit(Integrators& integrators, const Job& job, double H, double others, Contest& contest);
  bool fast_modes_are_quiet(Integrators& integrators, const Job& job, Method method, double H);
  double implicit_work(Integrators& integrators, const Job& job, Method method, double H, double budget);
  double controlled_work(Integrators& integrators, const Job& job, Method method, double H);

  Run start_;
  State fine_;
  double spent_ = 0;  ///< work of the race at hand
};

}  // namespace softffd
