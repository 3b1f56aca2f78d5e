/// Leapfrog (velocity Verlet): the central difference of Xia & Wang 2009, eq. (13), written in velocities, which keeps the digits that the
/// recurrence in positions loses to round-off; second order, symplectic without damping, one force evaluation per step.
#pragma once
#include "contact/contact.hpp"
#include "model/state.hpp"

namespace softffd {

class Leapfrog {
 public:
  Leapfrog(int points, int planes);
  void body_changed() { kicks_.invalidate(); }
  /// Advances the state; on failure the state is spoilt and the caller restores it. `watch`: accumulate dissipated energy and work.
  StepStatus advance(const Body& body, const Drive& around, const Span& span, bool watch, State& state, Exchange& exchange);
  /// Impacts so far (Contact::impacts).
  Count impacts() const { return contact_.impacts(); }

 private:
  HalfKicks kicks_;
  Contact contact_;
  Points before_, start_, next_;  ///< velocities before a half kick and before the step, positions after the drift
  Points force_;                  ///< outside forces now, where they ramp
};

}  // namespace softffd
