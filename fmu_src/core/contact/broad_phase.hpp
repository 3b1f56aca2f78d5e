/// Broad phase: tests whether control points can meet an obstacle, before and after an interval that a method without contact integrates.
#pragma once
#include "body/equations.hpp"
#include "model/state.hpp"

namespace softffd {

/// Returns the smallest gap of the control points to the obstacle [m].
double least_gap(const HalfSpace& obstacle, const Points& x);
/// Returns the smallest gap to the obstacle [m]: of the samples if obstacles meet the surface, otherwise of the control points.
double least_gap(const Body& body, const HalfSpace& obstacle, const Points& x);

/// The half-space of an obstacle at time t that a control point or a sample is nearest to, or farthest behind, and the gap there [m].
struct Facing {
  HalfSpace obstacle;
  double gap;
};
Facing facing(const Body& body, const Plane& obstacle, double t, const Points& x);

/// True if every point of x is in front of all obstacles at time t by more than `gap` [m], and of solids by more than `of_solids` [m] too.
bool off_obstacles(const Drive& around, double t, const Points& x, double gap, double of_solids = 0);

/// The same for the samples of the surface if obstacles meet those, otherwise for the control points.
bool off_obstacles(const Body& body, const Drive& around, double t, const Points& x, double gap, double of_solids = 0);

/// Forecasts how far a point can move within H, from the present speeds and the outside forces [m].
double forecast_way(const Equations& equations, const State& state, double H);

class BroadPhase {
 public:
  /// samples: those of the surface if obstacles meet the surface; then the hull of the samples has to stay in front of obstacles.
  explicit BroadPhase(int points, const Samples* samples = nullptr) : samples_(samples), gap_(points), middle_(points, 3) {}
  /// Forecasts the way of `forecast_way` for a stiff body, whose deformation changes by at most `vibration` [m]; infinite if pins hold it.
  double stiff_way(const Equations& equations, const State& state, double H, double vibration);
  /// True if a point that moves this way [m] within H could reach an obstacle, by bounds of the obstacles' own motion.
  bool may_touch(const Equations& equations, const State& state, double H, double way);
  /// True if a point is behind an obstacle at t1, or could have been behind one in between, judged by the gaps and speeds at both ends
  /// and by the cubic through both ends. The test does not cover a point that swings to and fro more than once in the step.
  bool passed(const Drive& around, double t0, double t1, const Points& x0, const Points& v0, const Points& x1, const Points& v1);

 private:
  double least_gap(const HalfSpace& obstacle, const Points& x);
  const Samples* samples_;
  Scalars gap_, room_;
  Points middle_;
};

}  // namespace softffd
