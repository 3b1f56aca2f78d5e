/// Obstacles in rigid motion: half-spaces behind planes, and solids (contact/surface/tangents.hpp).
#pragma once
#include <Eigen/Geometry>
#include <cmath>

#include "machine/elementary.hpp"
#include "model/free_body.hpp"
#include "model/rotation.hpp"

namespace softffd {

/// The part of v along a plane with this unit normal.
inline Vec3 tangential(const Vec3& normal, const Vec3& v) { return v - normal.dot(v) * normal; }

/// The obstacle at one moment: solid where normal . x < offset.
struct HalfSpace {
  Vec3 point, normal;  ///< [m], unit vector
  double offset;       ///< normal . point [m]
  Vec3 velocity;       ///< of the obstacle at `point` [m/s]
  Vec3 spin;           ///< its angular velocity [rad/s]

  double gap(const Vec3& x) const { return normal.dot(x) - offset; }
  /// Velocity of the obstacle's material at x [m/s].
  Vec3 material_velocity(const Vec3& x) const { return velocity + spin.cross(x - point); }
};

/// Pose and motion at one moment, as a host gives them.
struct PlaneMotion {
  Vec3 point = Vec3::Zero();                 ///< [m]
  Vec3 normal = Vec3::UnitZ();               ///< of any length but 0; the solid is on the other side
  Vec3 velocity = Vec3::Zero();              ///< of the obstacle at `point` [m/s]
  Vec3 angular_velocity = Vec3::Zero();      ///< about `point` [rad/s]
  double friction = 0;                       ///< Coulomb coefficient, >= 0
  bool moved_by_input = false;               ///< the pose belongs to the communication point; otherwise to the start time
  Vec3 acceleration = Vec3::Zero();          ///< [m/s2]
  Vec3 angular_acceleration = Vec3::Zero();  ///< [rad/s2]
  Vec3 normal_rate = Vec3::Zero();           ///< time derivative of `normal` before normalising [1/s]
  double radius = 0;                         ///< of a solid of revolution about `point` [m]; 0: none
  double length = 0;                         ///< of a cylinder along `normal` [m]; 0: a sphere
  Vec3 sides = Vec3::Zero();                 ///< of a box about `point` [m]; 0: none
  Vec3 rotation = Vec3::Zero();              ///< of a box: the vector that turns its edges from the axes of the world [rad]
  Vec3 rotation_rate = Vec3::Zero();         ///< its time derivative [rad/s]

  bool box() const { return sides[0] > 0; }
  bool solid() const { return radius > 0 || box(); }
  /// Of a solid: its furthest point from `point` [m].
  double size() const { return box() ? 0.5 * sides.norm() : hypotenuse(radius, 0.5 * length); }
};

/// A solid at one moment. A box has no normal of its own: it is that of an end across the third edge.
struct SolidPose : HalfSpace {
  Eigen::Matrix3d edges;  ///< of a box: their directions, in columns
};

/// The same from time `since` on, with a normal of unit length, which turns with the angular velocity, or, where a rate of the normal or
/// of the rotation is given, follows it.
struct Plane : PlaneMotion {
  double since = 0;  ///< [s]
  Vec3 facing =
      Vec3::Zero();  ///< of a solid for which a supporting half-space stands: its unit normal: of a box by its edges, of others at `since`

  const FreeMotion* own = nullptr;  ///< that of a free body, in the place of all above

  /// Does a half-space stand for the solid that it holds (contact/surface/stand_ins.hpp)?
  bool stood_for() const { return !facing.isZero(0); }
  /// A solid that is met as itself.
  bool solid() const { return PlaneMotion::solid() && !stood_for(); }
  /// The half-space, that which stands for a solid too.
  HalfSpace at(double time) const;
  SolidPose pose_at(double time) const;
  /// Of the free body that it is.
  SolidPose pose_of(const FreeState& state) const;
  /// Is x in the solid in this pose, or at most so far out of one of its faces [m]?
  bool holds(const SolidPose& pose, const Vec3& x, double slack) const;
  /// Is it the same at all times?
  bool at_rest() const;
};

/// Bounds of a plane's own motion between two times, as a point at rest sees it.
struct PlaneWay {
  double speed;      ///< of the gap [m/s]
  double deviation;  ///< of the gap from the straight line between its values at both ends [m]; 0 for a plane in steady translation
};
/// arm: largest distance of a point from the plane's point at t0 [m]. Infinite where a normal that is followed by its rate vanishes.
PlaneWay way_between(const Plane& plane, double t0, double t1, double arm);

}  // namespace softffd
