/// The body, its forces, and all that follows from the material: constant within a communication step.
#pragma once
#include "body/stability.hpp"

namespace softffd {

struct Model {
  explicit Model(Body of);

  Body body;
  Stability stability;
  Scalars time_scale;         ///< (3 * points) position error that a velocity error amounts to [s]
  Scalars memory;             ///< (3 * points) in which damping forgets an error [s]; infinite without damping
  double longest_memory = 0;  ///< of all points [s]
  /// For how long a velocity of the whole body lasts at most: drag takes vibrations, whose energy is half elastic, in twice the time [s].
  double longest_lasting() const { return 0.5 * longest_memory; }
  double noise = 0;  ///< energy of displacements that are rounding [J]

  /// Call when masses, stiffness, damping or the pinned points have changed: derives all the rest and makes a new version, by which
  /// methods know that what they keep is old.
  void renew();
};

}  // namespace softffd
