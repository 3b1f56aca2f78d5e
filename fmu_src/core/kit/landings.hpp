/// What landings make of errors, by a neighbour of the motion: where a body lands, a second one begins as far off as this one may be, and
/// goes beside it, in shorter steps at impacts and else in the coarser ones of a stretch that is run twice, until both have landed and are
/// off all obstacles, or stay on one for as long as the slowest vibration takes.
///
///      landing              contact                    flight                        next landing
///      places off by d  ->  steps of both bodies   ->  what they differ by, kept  -> d: that, moved on with its rigid part
///
/// A landing later or earlier by itself is no error that grows: what follows is the same, only later. What grows is that the vibrations, or
/// the attitude, are others when the body lands; and what one contact adds, the next may take away. Runs tell that, a product of factors
/// does not. Vibrations land as far out of phase as two runs of the contact before have left them, or, where that is not known, by a share
/// of the tolerance.
#pragma once
#include "kit/integrators.hpp"

namespace softffd {

class Landings {
 public:
  explicit Landings(const Run& run) : physical_(run.physical) {}
  /// The run has come from begin by these steps, or by twice as many. impact: something came onto an obstacle. flown: what
  /// vibrations may be off by when they land [m]; 0: it is not known. anyway: even where something touched before.
  void follow(Integrators& integrators, const StepContext& context, const State& begin, Method method, const Span& span, bool impact,
              double flown = 0, bool anyway = false);
  /// Whether steps from this time on are of a landing, in which the neighbour's are short; else it rattles.
  static bool lands(const StepContext& context, double time, bool impact);
  /// The neighbour is no longer integrated beside the run; their difference is kept.
  void part(const StepContext& context, bool flies);

 private:
  PhysicalState physical_;
};

}  // namespace softffd
