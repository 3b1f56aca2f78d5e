/// The central difference exactly as published (Xia & Wang 2009, eq. (11), (13) and, with the sign of (14) corrected, (14) to (17)): for
/// reproduction.
///
/// A recurrence in positions, so refining the step costs digits to round-off. A point found behind a plane at time t gets the acceleration
/// that makes its normal velocity relative to the plane zero, which by eq. (17) is x_{t+h} . n = x_{t-h} . n: the step is retraced. That
/// is an elastic bounce, and the point is inside the obstacle by up to one step's travel at every contact. Friction takes from the slip
/// x_{t+h} - x_t relative to the surface at most mu times the normal correction. Use leapfrog for anything else.
#pragma once
#include "methods/integrator.hpp"

namespace softffd {

class CentralDifference final : public Integrator {
 public:
  explicit CentralDifference(int points) : next_(points, 3), force_(points, 3) {}
  /// Velocities at the end are eq. (10) with one more step looked ahead.
  Outcome advance(const Model& model, const Drive& drive, const Span& span, Run& run) override;

 private:
  void step(const Body& body, const Drive& around, double t, double h, const State& state, Exchange* exchange);
  Points next_, force_;
};

}  // namespace softffd
