/// Whether control points can meet an obstacle: before a stretch of time that a method without contact is to take, and after it.
#pragma once
#include "body/equations.hpp"
#include "model/state.hpp"

namespace softffd {

/// The least gap of control points [m].
double least_gap(const HalfSpace& obstacle, const Points& x);
/// Gap of what may meet the obstacle: the least of the control points', or, where it meets the surface, of the samples' [m].
double least_gap(const Body& body, const HalfSpace& obstacle, const Points& x);

/// Of an obstacle at time t the half-space that a control point, or a sample, is nearest to, or furthest behind, and its gap [m].
struct Facing {
  HalfSpace obstacle;
  double gap;
};
Facing facing(const Body& body, const Plane& obstacle, double t, const Points& x);

/// Is every point at x off all obstacles at time t, by more than `gap` [m]?
bool off_obstacles(const Drive& around, double t, const Points& x, double gap);

/// The same of the surface's samples, where obstacles meet them and not the control points.
bool off_obstacles(const Body& body, const Drive& around, double t, const Points& x, double gap);

/// How far a point may go within H, at its present speed and under the outside forces [m]: a forecast.
double forecast_way(const Equations& equations, const State& state, double H);

class BroadPhase {
 public:
  /// samples: of the surface, where obstacles meet it; their hull has to stay off then.
  explicit BroadPhase(int points, const Samples* samples = nullptr) : samples_(samples), gap_(points), middle_(points, 3) {}
  /// Could a point come to an obstacle within H, by that forecast? The obstacles' own motion is bounded.
  bool may_touch(const Equations& equations, const State& state, double H);
  /// Is a point behind an obstacle at t1, or could one have been in between, going by the gaps and speeds at both ends and by the cubic
  /// through them? A point that swings to and fro more than once in the step is beyond that.
  bool passed(const Drive& around, double t0, double t1, const Points& x0, const Points& v0, const Points& x1, const Points& v1);

 private:
  double least_gap(const HalfSpace& obstacle, const Points& x);
  const Samples* samples_;
  Scalars gap_, room_;
  Points middle_;
};

}  // namespace softffd
