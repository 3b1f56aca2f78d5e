/// Leapfrog through contact with steps that follow the tolerance: impacts spoil what was true a moment ago, so that every stretch is its
/// own trial. It is run twice, with h and h / 2, and the finer run counts; where that differs too much, again with smaller steps. Where
/// experience says that the largest stable step is accurate enough, stretches are run once.
#pragma once
#include "kit/integrators.hpp"
#include "kit/landings.hpp"
#include "model/arithmetic.hpp"

namespace softffd {

class StepDoubling {
 public:
  explicit StepDoubling(const Run& run) : start_(run.physical), landings_(run), coarse_(run.physical.motion) {}
  /// To `end`, or until so much work is spent.
  StepStatus run(Integrators& integrators, const StepContext& context, double end, double most = infinity);
  Landings& landings() { return landings_; }

 private:
  /// The next stretch of what is left.
  struct Stretch {
    double limit, h;  ///< largest stable step, step of the coarser run [s]
    double end;       ///< of the communication step [s]
    bool first;       ///< in it
    bool at_limit() const { return h == limit; }
  };
  StepStatus run_stretch(Integrators& integrators, const StepContext& context, Stretch stretch, Count& taken);
  PhysicalState start_;
  Landings landings_;
  State coarse_;
};

}  // namespace softffd
