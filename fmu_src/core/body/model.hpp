/// The body, its forces, and all quantities that follow from the material. The model is constant within a communication step.
#pragma once
#include "body/stability.hpp"

namespace softffd {

struct Model {
  explicit Model(Body of);

  Body body;
  Stability stability;
  Scalars time_scale;         ///< (3 * points) position error per velocity error [s]
  Scalars memory;             ///< (3 * points) time in which damping forgets an error [s]; infinite without damping
  double longest_memory = 0;  ///< largest memory of all points [s]
  /// Longest time that a velocity of the whole body lasts [s]. Vibrations, whose energy is half elastic, last twice as long under drag.
  double longest_lasting() const { return 0.5 * longest_memory; }
  double noise = 0;  ///< energy of displacements that are rounding [J]

  /// Derives all other fields and makes a new version of the body, which tells methods that their stored data are old. Call this function
  /// after a change of masses, stiffness, damping or the pinned points.
  void renew();
};

}  // namespace softffd
