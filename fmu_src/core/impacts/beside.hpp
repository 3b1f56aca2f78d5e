/// What the impacts, flights and rests of a stiff body beside obstacles receive, and the energy accounts of their steps.
#pragma once
#include "contact/broad_phase.hpp"
#include "kit/integrators.hpp"
#include "kit/outlook.hpp"

namespace softffd {

struct Beside {
  Integrators& integrators;
  const StepContext& context;
  double end;    ///< end of the communication step [s]
  double limit;  ///< largest stable explicit step [s]
};

/// True if all control points, or surface samples, are off all obstacles by more than `gap` times the largest side of the box.
inline bool off_obstacles(const StepContext& context, double gap) {
  const State& motion = context.run.physical.motion;
  return off_obstacles(context.model.body, context.drive, motion.time, motion.x, gap * context.model.body.length);
}
/// Returns the energy that the step from `from` lost beyond drag and friction [J]. given: energy from the obstacles (Outcome) [J].
double energy_lost(const StepContext& context, const State& from, double given);
/// Adds to the work in the exchange the work of force ramps from the positions `booked` to the present ones, and books the energy that is
/// missing from the balance then as dissipated. before: the exchange at the start.
void book_energies(const StepContext& context, const State& from, const Points& booked, const Exchange& before);

}  // namespace softffd
