/// RKN12(10): the Runge-Kutta-Nystrom pair of Dormand, El-Mikkawy and Prince (1987) for x'' = a(t, x), 17 stages. The stages have no
/// velocity, so that the method is for bodies without damping only.
#pragma once
#include "methods/runge_kutta.hpp"

namespace softffd {

class Rkn12 final : public RungeKutta {
 public:
  Rkn12(int points, int pins) : RungeKutta(Method::rkn12, tableaus::rkn12, points, pins) {}
};

}  // namespace softffd
