/// What the body gives back to the outside during one communication step.
#pragma once
#include <vector>

#include "model/types.hpp"

namespace softffd {

/// Time integral of a force and of its torque.
struct Impulse {
  Vec3 force = Vec3::Zero();   ///< [N s]
  Vec3 torque = Vec3::Zero();  ///< [N m s]
  void add(const Vec3& impulse, const Vec3& arm) {
    force += impulse;
    torque += arm.cross(impulse);
  }
};

/// What the outside received during the current communication step. Energies only accumulate when they are asked for.
struct Exchange {
  std::vector<Impulse> planes;  ///< of the body on each obstacle, torque about the plane's point
  std::vector<Impulse> pins;    ///< of the body on each fixture, torque about the frame's origin
  double dissipated = 0;        ///< energy lost to damping, friction and impacts [J]
  double work = 0;              ///< work of moving obstacles and pins on the body [J]
  Count contacts_resolved = 0;
};

}  // namespace softffd
