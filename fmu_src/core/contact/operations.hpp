/// Operations on numbers that contact of the surface may take, and has taken. Counted, never timed: a solver that has spent them gives up
/// at the same place on every machine. One stands for what a multiplication and an addition take in a loop over a register; loops
/// that wait for each sum count each as several.
#pragma once
#include <algorithm>
#include <limits>

#include "model/types.hpp"

namespace softffd {

class Operations {
 public:
  /// In the time of an evaluation of the spring forces of so many points.
  static double in_evaluation(Count points) { return 5000 * std::max(1.0, double(points) / 64); }
  /// To have the value of a sample, or a place, from those of the control points.
  static constexpr double of_value = 100, of_place = 300;

  void allow(double most) { done_ = 0, most_ = most; }
  /// What has been done stays.
  void limit(double most) { most_ = most; }
  void spend(double operations) { done_ += operations; }
  double done() const { return done_; }
  bool spent() const { return !(done_ <= most_); }

 private:
  double done_ = 0, most_ = std::numeric_limits<double>::infinity();
};

}  // namespace softffd
