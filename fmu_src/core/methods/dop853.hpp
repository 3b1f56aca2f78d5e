/// DOP853 of Dormand, Prince, Hairer: explicit Runge-Kutta, order 8(5,3), for bodies with damping.
#pragma once
#include "methods/runge_kutta.hpp"

namespace softffd {

class Dop853 final : public RungeKutta {
 public:
  Dop853(int points, int pins) : RungeKutta(Method::dop853, tableaus::dop853, points, pins) {}
};

}  // namespace softffd
