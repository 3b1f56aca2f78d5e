/// Stiff bodies beside obstacles, in communication steps that are long against their vibrations: explicit steps where an impact needs them,
/// and something else between impacts. How long an impact takes in steps does not depend on the stiffness.
///
///            nothing can be touched for long                    quiet, and pressed on
///      flight <------------------------------ impact, contact ------------------------> rest
///         |   ------------------------------>                <------------------------
///              something may be touched                        energy is lost, or the steps get short
///
///      flight   the rigid motion, and every vibration with its phase (flight/modal_flight.hpp): without it the next rebound is wrong. Its
///               length costs nothing. It ends before anything can be touched.
///      impact, contact   windows of explicit steps, each run with h and h / 2; what the two will differ by at the end of the run decides
///               whether the window stands. First steps after a flight are half as long.
///      rest     backward Euler, its rigid motion by the mean velocity, so that sliding is exact in steps of any length; each step with h
///               and with two of h / 2, unless a number of them has shown that nothing changes; it ends where a contact stops,
///               turns round, begins to slide or opens.
///
/// Who decides is energy: what the vibrations hold cannot move a body that is pressed on by a force F further than energy / F.
#pragma once
#include "impacts/rest_steps.hpp"
#include "impacts/windows.hpp"

namespace softffd {

class Impacts {
 public:
  Impacts(const Lattice& lattice, const Run& run)
      : flights_(lattice, run), windows_(run), rest_(run), before_(run.physical.motion), start_(run.physical) {}

  /// Can the body's motion be carried by its modes now? They are made where the material is new.
  bool rings_about_rest(const StepContext& context) { return flights_.rings_about_rest(context); }
  /// From the run's time to `end`. rings: `rings_about_rest` has just said so.
  StepStatus run(Integrators& integrators, const StepContext& context, double end, bool rings);

 private:
  StepStatus pass_over(const Beside& at);

  Flights flights_;
  Windows windows_;
  RestSteps rest_;
  State before_;
  PhysicalState start_;  ///< of what the budget may not be enough for
};

}  // namespace softffd
