/// Finds the longest fixed step that keeps the tolerance. From time to time a short sub-interval is run twice, with h and h / 2, and rolled
/// back. The difference D of the two runs grows with the length of the run, so that the step that ends within the tolerance is
///
///      h (tolerance / (c D T / stretch))^(1/p),      c = 2^p / (2^p - 1),
///
/// where T is the length of the run or the time in which damping forgets, whichever is shorter, and stretch is the sub-interval's length.
#pragma once
#include <optional>

#include "kit/integrators.hpp"

namespace softffd {

class Calibrator {
 public:
  explicit Calibrator(const Run& run) : start_(run.physical), coarse_(run.physical.motion) {}

  /// True if a new calibration is to be made for what is left [s] of the communication step.
  bool due(const StepContext& context, Method method, double H) const;
  /// Sets run.control.calibration(method) and returns the work.
  double calibrate(Integrators& integrators, const StepContext& context, Method method, double H, int rounds);

 private:
  std::optional<double> trial_error(Integrators& integrators, const StepContext& context, Method method, double h, Count steps);
  PhysicalState start_;
  State coarse_;
};

}  // namespace softffd
