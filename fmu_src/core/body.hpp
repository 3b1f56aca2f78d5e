/// The mechanical model of eq. (3): masses, springs, point damping. Constant during a step.
#pragma once
#include "springs.hpp"

namespace softffd {

struct Body {
  Springs springs;
  Scalars mass;              ///< (points) [kg], > 0
  Scalars damping;           ///< (points) [N s/m], >= 0
  std::vector<bool> pinned;  ///< (points) moved by a pin, not by forces
  bool damped = false;       ///< any damping > 0
  Scalars inverse_mass{};    ///< (3 * points), axis by axis; 0 where pinned [1/kg]
  Scalars damping_rate{};    ///< (3 * points), damping / mass; 0 where pinned [1/s]
  double length = 1;         ///< largest side of the box [m]: the scale of every tolerance on positions
  int points() const { return int(mass.size()); }
};

}  // namespace softffd
