/// The rigid part of a motion, and a rotation as backward Euler takes it.
#pragma once
#include "model/types.hpp"

namespace softffd {

struct RigidMotion {
  Vec3 centre;                                                ///< of mass [m]
  Vec3 velocity;                                              ///< of the centre [m/s]
  Vec3 spin;                                                  ///< with the angular momentum of the whole about the centre [rad/s]
  double mass = 0;                                            ///< [kg]
  Vec3 angular_momentum = Vec3::Zero();                       ///< about the centre [kg m2/s]
  Eigen::Matrix3d inverse_inertia = Eigen::Matrix3d::Zero();  ///< that takes it to the spin [1/(kg m2)]
};
/// Of points x [m] with velocities v [m/s], or with displacements [m]. Points on one line do not spin about it.
RigidMotion rigid_motion(const Scalars& mass, const Points& x, const Points& v);

/// Distance of the outermost point from the centre [m].
double radius_about(const Vec3& centre, const Points& x);

/// What a turn adds to turn x arm, so that the arm keeps its length: rotation by atan |turn| about the axis, which is the rotation next to
/// the displacement turn x arm, and the one that a backward Euler step gives a rigid body.
Vec3 second_order(const Vec3& turn, const Vec3& arm);

}  // namespace softffd
