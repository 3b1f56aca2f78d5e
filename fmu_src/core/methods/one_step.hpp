/// What the methods with error control share: they try a step and say how large its error is; the propagator decides.
#pragma once
#include <algorithm>

#include "forces/equations.hpp"
#include "model/state.hpp"

namespace softffd {

class OneStep {
 public:
  /// exponent: of the step size controller, order of the embedded method + 1.
  OneStep(int points, int pins, int exponent)
      : x(points, 3), v(points, 3), ledger(pins), exponent(exponent), time_scale(Scalars::Zero(3 * points)), error_(points, 3) {}
  virtual ~OneStep() = default;

  /// Tries a step of size h from (t, state), state.spring being the spring forces there; fills x, v and the ledger, which the caller has
  /// opened. Returns the estimated error [m]: the largest over all points, velocity errors times `time_scale`.
  virtual double attempt(const Equations& equations, double t, double h, const State& state) = 0;

  Points x, v;    ///< result of the last attempt: positions [m] and velocities [m/s], pinned points on their frames
  Ledger ledger;  ///< what the last attempt exchanged with the outside
  const int exponent;
  Scalars time_scale;  ///< (3 * points) position error that a velocity error amounts to [s]

 protected:
  double position_size(const Points& error) const { return kernels::largest(error.size(), error.data()); }
  double velocity_size(const Points& error) const { return kernels::largest_weighted(error.size(), time_scale.data(), error.data()); }
  Points error_;
};

}  // namespace softffd
