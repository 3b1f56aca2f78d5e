/// The central difference exactly as published (Xia & Wang 2009, eq. (11), (13) and, with the sign of (14) corrected, (14) to (17)): for
/// reproduction.
///
/// The method is a recurrence in positions, so that refining the step loses digits to round-off. A point behind a plane at time t gets the
/// acceleration that makes its normal velocity relative to the plane zero; by eq. (17) this is x_{t+h} . n = x_{t-h} . n, and the point
/// retraces its step. The bounce is elastic, and at every contact the point is inside the obstacle by up to one step's travel. Friction
/// reduces the slip x_{t+h} - x_t relative to the surface by at most mu times the normal correction. Use leapfrog for anything else.
#pragma once
#include "methods/integrator.hpp"

namespace softffd {

class CentralDifference final : public Integrator {
 public:
  explicit CentralDifference(int points) : next_(points, 3), force_(points, 3) {}
  /// The velocities at the end follow from eq. (10) with one more step computed ahead.
  Outcome advance(const Model& model, const Drive& drive, const Span& span, Run& run) override;

 private:
  void step(const Body& body, const Drive& around, double t, double h, const State& state, Exchange* exchange);
  Points next_, force_;
};

}  // namespace softffd
