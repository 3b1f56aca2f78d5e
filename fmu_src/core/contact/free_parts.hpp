/// Free bodies in an explicit step: half kicks of the parts of free pins, and flights.
#pragma once
#include "contact/contact.hpp"

namespace softffd {

/// Half a kick of the parts of free pins, by the forces on the points that they take along.
inline void kick_parts(const StepView& step, const Points& v, std::vector<FreeState>& free) {
  for (const FreeMotion& each : step.around.free) {
    if (!each.part()) continue;
    FreeState& state = free[each.index()];
    auto [force, torque] = each.loads(state);
    for (const int p : step.around.pins[each.body().pin].points) {
      const Vec3 own = row(step.spring, p) + row(step.force, p) - step.body.damping[p] * row(v, p);
      force += own;
      torque += (row(step.x0, p) - state.position).cross(own);
    }
    each.push(state, 0.5 * step.h * force, 0.5 * step.h * torque);
  }
}

/// To the end of the step, without contact.
inline void fly(const StepView& step, std::vector<FreeState>& free) {
  for (const FreeMotion& each : step.around.free) free[each.index()] = each.flown(free[each.index()], step.t1);
}

}  // namespace softffd
