/// Finds how landings amplify errors, by a neighbour of the motion: a second body that begins a landing as far off as the run itself may
/// be. The neighbour is integrated beside the run, with shorter steps at impacts and otherwise with the coarser steps of a sub-interval
/// that is run twice. It ends when both have landed and are in flight. It ends as well when both have stayed on
/// an obstacle for the slowest vibration's period, unless solids meet a body with internal damping that no pin holds: its vertices skip
/// along a solid without another landing, and a body that slides or rocks there may make an error a thousand times larger.
///
///      landing              contact                    flight                        next landing
///      places off by d  ->  steps of both bodies   ->  what they differ by, kept  -> d: that, moved on with its rigid part
///
/// A landing that is only late or early is not an error that grows: the same motion follows, only later. An error grows if the vibrations
/// or the attitude differ when the body lands, and one contact may cancel what another adds. Runs show this; a product of factors does not.
/// The phase of the vibrations at a landing is off by what two runs of the previous contact left, or, if that is unknown, by a fraction of
/// the tolerance; but by no less than what contact without a neighbour has added up to, as while a body rocks on its edges.
#pragma once
#include "kit/integrators.hpp"

namespace softffd {

class Landings {
 public:
  explicit Landings(const Run& run) : physical_(run.physical) {}
  /// The run has come from `begin` by these steps, or by twice as many. impact: something came onto an obstacle. flown: error that
  /// vibrations may have when they land [m]; 0: unknown. anyway: start a neighbour even if something touched before.
  void follow(Integrators& integrators, const StepContext& context, const State& begin, Method method, const Span& span, bool impact,
              double flown = 0, bool anyway = false);
  /// True if the neighbour stands for all errors at this time: for the slowest vibration's period after an impact.
  static bool landing(const StepContext& context, double time);
  /// True if steps from this time on belong to a landing, in which the neighbour takes short steps; otherwise the body rattles.
  static bool lands(const StepContext& context, double time, bool impact);
  /// Ends the integration of the neighbour beside the run and keeps their difference.
  void part(const StepContext& context, bool flies);

 private:
  PhysicalState physical_;
};

}  // namespace softffd
