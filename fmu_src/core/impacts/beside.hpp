/// A stiff body beside obstacles: what the steps of its impacts, flights and rests are given, and their accounts.
#pragma once
#include "contact/broad_phase.hpp"
#include "kit/integrators.hpp"
#include "kit/outlook.hpp"

namespace softffd {

struct Beside {
  Integrators& integrators;
  const StepContext& context;
  double end;    ///< of the communication step [s]
  double limit;  ///< largest stable explicit step [s]
};

/// Whether every point, or sample, is off all obstacles by this share of the box.
inline bool off_obstacles(const StepContext& context, double gap) {
  const State& motion = context.run.physical.motion;
  return off_obstacles(context.model.body, context.drive, motion.time, motion.x, gap * context.model.body.length);
}
/// Energy that a step from this state took beyond damping and friction, obstacles having given so much of it [J].
double energy_lost(const StepContext& context, const State& from, double given);
/// Adds the work of ramps on the way from `booked` to the present positions, and what the energies lack then as dissipated. before: the
/// exchange at the start.
void book_energies(const StepContext& context, const State& from, const Points& booked, const Exchange& before);

}  // namespace softffd
