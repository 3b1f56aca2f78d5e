/// Free bodies in an explicit step: half kicks of the parts of free pins, and free flight.
#pragma once
#include "contact/contact.hpp"

namespace softffd {

/// Gives the parts of free pins a half kick. impulse(p): impulse of the forces on point p in the half kick [N s].
template <class Impulse>
void kick_parts(const StepView& step, std::vector<FreeState>& free, const Impulse& impulse) {
  for (const FreeMotion& each : step.around.free) {
    if (!each.part()) continue;
    FreeState& state = free[each.index()];
    auto [force, torque] = each.loads(state);
    force *= 0.5 * step.h;
    torque *= 0.5 * step.h;
    for (const int p : step.around.pins[each.body().pin].points) {
      const Vec3 own = impulse(p);
      force += own;
      torque += (row(step.x0, p) - state.position).cross(own);
    }
    each.push(state, force, torque);
  }
}

/// Moves the free bodies to the end of the step, without contact.
inline void fly(const StepView& step, std::vector<FreeState>& free) {
  for (const FreeMotion& each : step.around.free) free[each.index()] = each.flown(free[each.index()], step.t1);
}

}  // namespace softffd
