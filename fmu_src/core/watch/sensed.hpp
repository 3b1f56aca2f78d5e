/// What is read from a body besides its state: contact forces on parts of the surface (watch/sensors.hpp), and points followed through a
/// communication step (watch/followed.hpp). A place is a control point, or a sample of the surface if samples meet obstacles.
#pragma once
#include <array>
#include <vector>

#include "model/basis.hpp"

namespace softffd {

struct Patch {
  /// Fraction of the force on a place that counts for a taxel.
  struct Fraction {
    int place, taxel;
    double fraction;
  };
  std::vector<int> places;
  std::vector<double> weights;      ///< of the places for the centre of the patch: areas of the patch around them, at rest [m2]
  std::vector<Fraction> fractions;  ///< the fractions of a place sum to 1; empty without taxels
  std::array<int, 2> taxels{0, 0};
  int taxel_count() const { return taxels[0] * taxels[1]; }
};

struct FollowedPoint {
  Vec3 at;               ///< at rest [m]
  bool maximum = false;  ///< the largest values within a communication step are wanted
  bool stress = false;   ///< the largest stress is wanted too
};

struct Sensed {
  Basis basis = Basis::bezier;
  std::vector<Patch> patches = {};
  std::vector<FollowedPoint> followed = {};
  std::vector<Vec3> areas = {};  ///< outward area vectors of the surface at the places, at rest [m2]; empty without patches
};

}  // namespace softffd
