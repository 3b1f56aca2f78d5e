/// What a frozen factor was made from: enough to make the same bits again.
#pragma once
#include "model/types.hpp"

namespace softffd {

struct Factored {
  Points x;               ///< configuration that the stiffness matrix belongs to [m]
  double h = 0;           ///< step that the factor belongs to [s]; 0: there is none
  Count uses = 0;         ///< steps tried with it
  bool in_frame = false;  ///< x is in the body's frame (floating_frame.hpp)
};

}  // namespace softffd
