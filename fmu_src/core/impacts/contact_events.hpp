/// Events of contacts within an implicit step, which step doubling does not detect (contact/slip.hpp).
#pragma once
#include "contact/slip.hpp"
#include "kit/step_context.hpp"

namespace softffd {

/// An event within a step: a contact stops, turns round, begins to slide or opens.
struct ContactEvent {
  double at = 0;     ///< approximate time after the beginning of the step [s]; 0: unknown
  double error = 0;  ///< final error of a step across the event, which step doubling does not detect [m]
};

/// Returns the event with the largest final error in the step from `from` to the present state; none for a pinned body. Outside forces are
/// linear in the step and taken at its middle: a contact that sticks by the middle's forces may slide by those of the end, and one that
/// slides by them may have stuck for a part of it. pressing: force on the obstacles [N]. slight: displacement that does not matter [m].
ContactEvent event_of(const StepContext& context, const Slip& slip, double pressing, const PhysicalState& from, double slight);

}  // namespace softffd
