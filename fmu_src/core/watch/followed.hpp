/// Points of the object that are followed through a communication step if their outputs ask for it: the mean acceleration, and the largest
/// values at the ends of internal steps.
///
/// A control point that lands stops at once. A point that it moves has no acceleration then that internal steps could determine: the
/// shorter the steps, the larger the value. The largest acceleration is therefore that of means over a radian of the lattice's fastest
/// vibration, or over an internal step if that is longer.
#pragma once
#include <optional>
#include <vector>

#include "body/model.hpp"
#include "forces/solid.hpp"
#include "model/run.hpp"
#include "watch/sensed.hpp"

namespace softffd {

class FollowedPoints {
 public:
  FollowedPoints(const Sensed& sensed, const Lattice& lattice);

  /// Call at the start of a run.
  void start(Run& run) const;
  /// Call when a communication step begins.
  void begin(const Model& model, Run& run);
  /// Call after an internal step of length h [s].
  void step(const Body& body, double h, Run& run) const;
  /// True if internal steps have to be looked at.
  bool every_step() const { return every_step_; }
  /// Call when a communication step ends. time: of its means [s]; 0: the readings stay as they are `before` it (watch/means.hpp).
  void end(const Body& body, double time, const Run& before, Run& run) const;

 private:
  struct Followed {
    Embedding at;
    std::optional<SolidPlace> place;  ///< set if its stress is wanted
    bool maximum;
    Vec3 value(const Points& points) const { return {at(points.col(0)), at(points.col(1)), at(points.col(2))}; }
  };
  void look(const Body& body, const Followed& each, double acceleration, const State& motion, PointReading& reading) const;

  std::vector<Followed> followed_;
  double radian_ = 0;  ///< time over which accelerations are averaged [s]
  bool every_step_ = false;
};

}  // namespace softffd
