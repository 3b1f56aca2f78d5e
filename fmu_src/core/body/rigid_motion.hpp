/// The rigid part of a motion, and the rotation of a backward Euler step.
#pragma once
#include "model/types.hpp"

namespace softffd {

struct RigidMotion {
  Vec3 centre;                                                ///< centre of mass [m]
  Vec3 velocity;                                              ///< velocity of the centre [m/s]
  Vec3 spin;                                                  ///< spin of the rigid body with the same angular momentum [rad/s]
  double mass = 0;                                            ///< [kg]
  Vec3 angular_momentum = Vec3::Zero();                       ///< about the centre [kg m2/s]
  Eigen::Matrix3d inverse_inertia = Eigen::Matrix3d::Zero();  ///< angular momentum to spin [1/(kg m2)]
};
/// Returns the rigid motion of points x [m] with velocities v [m/s] or displacements v [m]. Points on one line do not spin about the line.
RigidMotion rigid_motion(const Scalars& mass, const Points& x, const Points& v);

/// Returns the distance of the outermost point from the centre [m].
double radius_about(const Vec3& centre, const Points& x);

/// Returns the vector to add to turn x arm so that the arm keeps its length: a rotation by atan |turn| about the axis. This rotation is
/// the one closest to the displacement turn x arm, and the one that a backward Euler step gives a rigid body.
Vec3 second_order(const Vec3& turn, const Vec3& arm);

}  // namespace softffd
