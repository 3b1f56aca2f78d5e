/// Contact forces on patches of the surface, as the outputs of sensors show them: means over the last communication step, where the body
/// is at its end.
#pragma once
#include <optional>

#include "model/drive.hpp"
#include "model/run.hpp"
#include "watch/load_spread.hpp"
#include "watch/sensed.hpp"

namespace softffd {

class Sensors {
 public:
  /// samples: of the surface; null: control points touch. All must outlive this.
  Sensors(const Sensed& sensed, const Lattice& lattice, const Samples* samples);

  /// After a communication step: what touched, in `run.sensors`. within: how far from an obstacle a sample is that it still touches [m].
  void read(const Drive& drive, double within, Run& run);

 private:
  void meet(const Plane& obstacle, double within, const Points& impulses, const State& motion);
  void show(const Patch& patch, const Run& run, SensorReading& reading) const;
  Vec3 place(int at, const Points& x) const { return samples_ ? samples_->at(at, x) : row(x, at); }
  Vec3 area(int at, const Points& x) const;

  const Sensed& sensed_;
  const Lattice& lattice_;
  const Samples* samples_;
  Points rest_;                       ///< control points at rest [m]
  std::optional<LoadSpread> spread_;  ///< of samples
  std::vector<Touch> touches_;        ///< of one obstacle [N s]
  SharedLoad load_;
  // of all places, by all obstacles:
  Points force_;                       ///< [N s]
  Scalars pressing_, area_, largest_;  ///< along the normals [N s]; where that counts [m2]; their ratio, the largest [N s / m2]
};

}  // namespace softffd
