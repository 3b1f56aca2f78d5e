/// Events of contacts within an implicit step, which step doubling does not see (contact/slip.hpp).
#pragma once
#include "contact/slip.hpp"
#include "kit/step_context.hpp"

namespace softffd {

/// A contact that stops, turns round, begins to slide or opens within a step.
struct ContactEvent {
  double at = 0;     ///< about when, from the begin of the step on; 0: not known [s]
  double error = 0;  ///< what a step across it leaves at the end of the run, unseen by step doubling [m]
};

/// What changes in a step of a body that is not held, and when. Outside forces are linear in the step, and taken at its middle: what sticks
/// by the middle's forces may slide by those of the end, and what slides by them may have stuck for a part of it.
/// pressing: the force on the obstacles in the step [N]. from: where it began. slight: way that does not matter [m].
ContactEvent event_of(const StepContext& context, const Slip& slip, double pressing, const PhysicalState& from, double slight);

}  // namespace softffd
