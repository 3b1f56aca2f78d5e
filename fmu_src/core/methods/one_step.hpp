/// Base of the methods with error control: they offer a step with an estimate of its error, and the step size controller
/// (stepping/controlled_steps.hpp) keeps or rejects the step. A given step is kept without a check.
#pragma once
#include <algorithm>

#include "methods/integrator.hpp"

namespace softffd {

class OneStep : public Integrator {
 public:
  /// exponent: of the step size controller, order of the embedded method + 1. lossy: the method itself dissipates energy.
  OneStep(Method name, int points, int pins, int exponent, bool lossy = false)
      : x(points, 3),
        v(points, 3),
        ledger(pins),
        exponent(exponent),
        time_scale(Scalars::Zero(3 * points)),
        error_(points, 3),
        name_(name),
        lossy_(lossy) {}

  /// Offers a step of size h from (t, run.physical.motion): fills x, v and the ledger, and does not change the motion. A result that is not
  /// finite has an infinite error.
  Outcome offer(const Model& model, const Drive& drive, double t, double h, Run& run);
  /// Commits the step that was offered last.
  void keep(const Model& model, Run& run);
  Outcome advance(const Model& model, const Drive& drive, const Span& span, Run& run) override;

  /// Tries a step of size h from (t, state), where state.spring holds the spring forces; fills x, v and the ledger, which the caller has
  /// opened. Returns the estimated error [m]: the largest over all points, with velocity errors multiplied by `time_scale`.
  virtual double attempt(const Equations& equations, double t, double h, const State& state) = 0;

  Points x, v;    ///< result of the last attempt: positions [m] and velocities [m/s], pinned points on their frames
  Ledger ledger;  ///< what the last attempt exchanged with the outside
  const int exponent;
  Scalars time_scale;  ///< (3 * points) position error that a velocity error amounts to [s]

 protected:
  /// Makes an attempt with all that it needs from the run besides the motion. Methods that solve with a matrix override this.
  virtual Outcome attempt_in(const Equations& equations, double t, double h, Run& run);
  /// Called before the first attempt with a new version of the material.
  virtual void take_material(const Model& model) { time_scale = model.time_scale; }
  double position_size(const Points& error) const { return kernels::largest(error.size(), error.data()); }
  double velocity_size(const Points& error) const { return kernels::largest_weighted(error.size(), time_scale.data(), error.data()); }
  Points error_;

 private:
  Method name_;
  bool lossy_;
  Count version_ = -1;  ///< of the body
};

}  // namespace softffd
