/// Stiff bodies beside obstacles, in communication steps that are long compared with their vibrations. Explicit steps are taken where an
/// impact needs them, and other methods take the time between impacts. The number of steps of an impact does not depend on the stiffness.
///
///            nothing can be touched for long                    quiet, and pressed on
///      flight <------------------------------ impact, contact ------------------------> rest
///         |   ------------------------------>                <------------------------
///              something may be touched                        energy is lost, or the steps get short
///
///      flight   the rigid motion, and every vibration with its phase (flight/modal_flight.hpp): without the phase the next rebound is
///               wrong. The length of a flight costs nothing. A flight ends before anything can be touched.
///      impact, contact   windows of explicit steps. Each window is run with h and with h / 2, and is accepted if the final error between
///               the two results is small enough. The first steps after a flight are half as long.
///      rest     backward Euler, with the rigid motion by the mean velocity, so that sliding is exact in steps of any length. Each step is
///               run with h and with two of h / 2, unless a number of steps has shown that nothing changes; a step ends where a contact
///               stops, turns round, begins to slide or opens.
///
/// Energy decides between the phases: vibrations cannot move a body that is pressed on by a force F further than their energy / F. Where
/// that force ends they could: the energy that steps at rest have damped away is missing in the flight that follows.
#pragma once
#include "impacts/rest_steps.hpp"
#include "impacts/windows.hpp"

namespace softffd {

class Impacts {
 public:
  Impacts(const Lattice& lattice, const Run& run)
      : flights_(lattice, run), windows_(run), rest_(run), before_(run.physical.motion), start_(run.physical) {}

  /// True if the modes can carry the present motion of the body. Computes the modes if the material has changed.
  bool rings_about_rest(const StepContext& context) { return flights_.rings_about_rest(context); }
  /// Runs from the present time to `end` [s]. rings: `rings_about_rest` has just returned true.
  StepStatus run(Integrators& integrators, const StepContext& context, double end, bool rings);

 private:
  StepStatus pass_over(const Beside& at);

  Flights flights_;
  Windows windows_;
  RestSteps rest_;
  State before_;
  PhysicalState start_;  ///< snapshot before a part for which the budget may not suffice
};

}  // namespace softffd
