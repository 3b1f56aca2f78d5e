/// DOP853 of Dormand, Prince, Hairer: explicit Runge-Kutta, order 8(5,3), for bodies with damping.
#pragma once
#include <array>

#include "methods/one_step.hpp"

namespace softffd {

class Dop853 final : public OneStep {
 public:
  Dop853(int points, int pins);
  double attempt(const Equations& equations, double t, double h, const State& state) override;

 private:
  using Slopes = std::array<Points, 12>;
  Slopes v_, a_;  ///< velocities and accelerations at the stages
  Points stage_x_, spring_, outside_, zero_;
};

}  // namespace softffd
