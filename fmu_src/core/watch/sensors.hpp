/// Contact forces on patches of the surface, as the outputs of sensors report them: means over the last communication step, with the body
/// in its position at the end of that step.
#pragma once
#include <optional>

#include "model/drive.hpp"
#include "model/run.hpp"
#include "watch/load_spread.hpp"
#include "watch/sensed.hpp"

namespace softffd {

class Sensors {
 public:
  /// samples: of the surface; null if control points meet obstacles. All arguments must outlive this object.
  Sensors(const Sensed& sensed, const Lattice& lattice, const Samples* samples);

  /// Call after a communication step: writes `run.sensors`. within: gap up to which a sample counts as touching an obstacle [m]. time: of
  /// the means [s] (watch/means.hpp).
  void read(const Drive& drive, double within, double time, Run& run);

 private:
  void find_touches(const Plane& obstacle, double within, const Points& impulses, const State& motion);
  void show(const Patch& patch, const Run& run, double once, SensorReading& reading) const;
  Vec3 place(int at, const Points& x) const { return samples_ ? samples_->at(at, x) : row(x, at); }
  Vec3 area(int at, const Points& x) const;

  const Sensed& sensed_;
  const Lattice& lattice_;
  const Samples* samples_;
  Points rest_;                       ///< control points at rest [m]
  std::optional<LoadSpread> spread_;  ///< set if samples meet obstacles
  std::vector<Touch> touches_;        ///< impulses of one obstacle [N s]
  DistributedLoad load_;
  // for each place, over all obstacles:
  Points force_;                       ///< impulse [N s]
  Scalars pressing_, area_, largest_;  ///< impulse along the normals [N s]; area that counts [m2]; largest impulse per area [N s / m2]
};

}  // namespace softffd
