/// What is read of a body beside its state: contact forces on parts of the surface (watch/sensors.hpp), and points followed through a
/// communication step (watch/followed.hpp). A place is a control point, or a sample of the surface where
/// these meet obstacles.
#pragma once
#include <array>
#include <vector>

#include "model/basis.hpp"

namespace softffd {

struct Patch {
  /// Of the force on a place, what counts for a taxel.
  struct Share {
    int place, taxel;
    double share;
  };
  std::vector<int> places;
  std::vector<double> weights;  ///< of the places in its centre: areas of the patch around them, at rest [m2]
  std::vector<Share> shares;    ///< those of a place sum to 1; none without taxels
  std::array<int, 2> taxels{0, 0};
  int taxel_count() const { return taxels[0] * taxels[1]; }
};

struct FollowedPoint {
  Vec3 at;               ///< at rest [m]
  bool maximum = false;  ///< the largest values within a communication step
  bool stress = false;   ///< of the stress too
};

struct Sensed {
  Basis basis = Basis::bezier;
  std::vector<Patch> patches = {};
  std::vector<FollowedPoint> followed = {};
  std::vector<Vec3> areas = {};  ///< of the surface at each place at rest, outward [m2]; none without patches
};

}  // namespace softffd
