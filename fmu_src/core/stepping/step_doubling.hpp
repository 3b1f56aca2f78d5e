/// Leapfrog through contact with steps that follow the tolerance. Impacts invalidate earlier experience, so that every sub-interval is its
/// own trial: it is run with h and h / 2, and the finer run counts; if the two differ too much, it is run again with smaller steps. Where
/// experience shows that the largest stable step is accurate enough, sub-intervals are run once.
#pragma once
#include "kit/integrators.hpp"
#include "kit/landings.hpp"
#include "model/arithmetic.hpp"

namespace softffd {

class StepDoubling {
 public:
  explicit StepDoubling(const Run& run) : start_(run.physical), landings_(run), coarse_(run.physical.motion) {}
  /// Runs to `end`, or until this work is spent.
  StepStatus run(Integrators& integrators, const StepContext& context, double end, double most = infinity);
  Landings& landings() { return landings_; }

 private:
  /// The next sub-interval of what is left.
  struct Stretch {
    double limit, h;  ///< largest stable step, step of the coarser run [s]
    double end;       ///< end of the communication step [s]
    bool first;       ///< it is the first of the communication step
    bool at_limit() const { return h == limit; }
  };
  StepStatus run_stretch(Integrators& integrators, const StepContext& context, Stretch stretch, Count& taken);
  PhysicalState start_;
  Landings landings_;
  State coarse_;
};

}  // namespace softffd
