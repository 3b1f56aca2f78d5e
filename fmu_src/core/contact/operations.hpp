/// Number of operations that contact of the surface may take and has taken. Operations are counted, never timed: a solver that has spent
/// its operations gives up at the same place on every machine. One operation stands for a multiplication and an addition in a loop over
/// registers; loops that have to wait for each sum count each as several.
#pragma once
#include <algorithm>
#include <limits>

#include "model/types.hpp"

namespace softffd {

class Operations {
 public:
  /// Returns the number of operations that take as long as one evaluation of the spring forces of this many points.
  static double in_evaluation(Count points) { return 5000 * std::max(1.0, double(points) / 64); }
  /// Operations to compute a value, or the place, of a sample from those of the control points.
  static constexpr double of_value = 100, of_place = 300;

  void allow(double most) { done_ = 0, most_ = most; }
  /// Sets the limit; the operations done so far still count.
  void limit(double most) { most_ = most; }
  void spend(double operations) { done_ += operations; }
  double done() const { return done_; }
  bool spent() const { return !(done_ <= most_); }

 private:
  double done_ = 0, most_ = std::numeric_limits<double>::infinity();
};

}  // namespace softffd
