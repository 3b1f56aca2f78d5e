/// RKN12(10): the Runge-Kutta-Nystrom pair of Dormand, El-Mikkawy and Prince (1987) for x'' = a(t, x), 17 stages. Bodies without damping
/// only: stages have no velocity.
#pragma once
#include <array>

#include "methods/one_step.hpp"

namespace softffd {

class Rkn12 final : public OneStep {
 public:
  Rkn12(int points, int pins);
  double attempt(const Equations& equations, double t, double h, const State& state) override;

 private:
  std::array<Points, 17> k_;  ///< accelerations at the stages
  Points stage_, spring_, outside_, zero_;
};

}  // namespace softffd
