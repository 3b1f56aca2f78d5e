/// What a frozen factor was made from: enough to make the same bits again.
#pragma once
#include "model/visit.hpp"

namespace softffd {

struct Factored {
  MarkedPoints x;         ///< configuration that the stiffness matrix belongs to [m]
  double h = 0;           ///< step that the factor belongs to [s]; 0: there is none
  Count uses = 0;         ///< steps tried with it
  bool in_frame = false;  ///< x is in the body's frame (floating_frame.hpp)

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.x, s.h, s.uses, s.in_frame);
  }
};
static_assert(visits_every_field<Factored>);

}  // namespace softffd
