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
  Vec3 rotation = Vec3::Zero();              ///< of a box: rotation vector from the world's axes to its edges [rad]
  Vec3 rotation_rate = Vec3::Zero();         ///< its time derivative [rad/s]

  bool box() const { return sides[0] > 0; }
  bool solid() const { return radius > 0 || box(); }
  /// Returns the distance of the solid's furthest point from `point` [m].
  double size() const { return box() ? 0.5 * sides.norm() : hypotenuse(radius, 0.5 * length); }
};

/// A solid at one moment. The normal of a box is that of the end across its third edge.
struct SolidPose : HalfSpace {
  Eigen::Matrix3d edges;  ///< of a box: directions of its edges, in columns
};

/// The motion from time `since` on, with a unit normal. The normal turns with the angular velocity, or, if a rate of the normal or of the
/// rotation is given, follows that rate.
struct Plane : PlaneMotion {
  double since = 0;  ///< [s]
  /// Of a solid that a supporting half-space replaces: unit normal of the half-space, for a box in its edges, else at `since`. Zero: none.
  Vec3 facing = Vec3::Zero();

  const FreeMotion* own = nullptr;  ///< motion of a free body, which replaces all fields above

  /// True if a supporting half-space replaces the solid (contact/stand_ins.hpp).
  bool stood_for() const { return !facing.isZero(0); }
  /// True for a solid that keeps its own shape in contact.
  bool solid() const { return PlaneMotion::solid() && !stood_for(); }
  /// Returns the half-space of a plane, or the supporting half-space that replaces a solid.
  HalfSpace at(double time) const;
  SolidPose pose_at(double time) const;
  /// Returns the pose of the free body in this state.
  SolidPose pose_of(const FreeState& state) const;
  /// True if x is inside the solid in this pose, or at most `slack` [m] outside one of its faces.
  bool holds(const SolidPose& pose, const Vec3& x, double slack) const;
  /// True if the obstacle never moves.
  bool at_rest() const;
  /// True if inputs or parameters turn or accelerate it during a communication step.
  bool bends() const;
};

/// Bounds of a plane's own motion between two times, as seen from a point at rest.
struct PlaneWay {
  double speed;      ///< largest speed of the gap [m/s]
  double deviation;  ///< of the gap from the straight line between its values at both ends [m]; 0 for a plane in steady translation
};
/// arm: largest distance of a point from the plane's point at t0 [m]. The bounds are infinite if a normal that follows its rate vanishes.
PlaneWay way_between(const Plane& plane, double t0, double t1, double arm);

}  // namespace softffd
