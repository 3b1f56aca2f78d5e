/// A rigid body under the outside forces of a soft one. Forces and their derivatives stay with their points and keep their directions in
/// the world, and nodal viscous drag -d v acts on the points. With the sums
///
///      F = sum f,   G = sum r f^T,   d0 = sum d,   d1 = sum d r,   D = sum d (r.r - r r^T),   I = sum m (r.r - r r^T)
///
/// over the arms r from the centre of mass at the start, and with the rotation R since then,
///
///      m v' = F - d0 v - w x R d1,   L' = (R G)^x - R d1 x v - R D R^T w,   w = R I^-1 R^T L,   q' = w q / 2,
///
/// where (A)^x is the sum over j, k of epsilon_ijk A_jk, so that an evaluation costs the same for any number of points. The angular
/// momentum L about the centre is an unknown of its own: without torque it keeps every bit.
///
/// The equations are integrated by extrapolation of the midpoint rule to order 12 (Gragg 1965; Hairer, Norsett, Wanner 1993, section
/// II.9), in pieces that are short compared with the turning.
#pragma once
#include <Eigen/Geometry>
#include <array>

#include "body/equations.hpp"

namespace softffd {

/// Motion at one time, with the accelerations by the forces at that time.
struct RigidState {
  Vec3 centre, velocity, acceleration;     ///< [m], [m/s], [m/s2]
  Vec3 spin, spin_rate, angular_momentum;  ///< [rad/s], [rad/s2], about the centre [kg m2/s]
  Eigen::Matrix3d turn;                    ///< R
};

class RigidBody {
 public:
  /// Starts with the momentum and the angular momentum of points x [m] with velocities v [m/s] at time t [s]. inner: additional angular
  /// momentum, that of the vibrations, which turns with the body and does not turn it [kg m2/s].
  void start(const Equations& equations, double t, const Points& x, const Points& v, const Vec3& inner = Vec3::Zero());
  /// Returns about the longest step that can be followed from here [s].
  double longest_step() const;
  /// Advances by h [s]. Returns the error estimate, a position error of the outermost point [m]. If the forces change too fast to follow,
  /// takes no step and returns infinity.
  double advance(double h);

  RigidState state() const;

 private:
  using Values = Eigen::Matrix<double, 13, 1>;  ///< centre, velocity, quaternion w x y z, angular momentum
  struct Rates {
    Vec3 acceleration, torque, spin;
  };
  Rates rates(double t, const Values& y, const Eigen::Matrix3d& turn) const;
  void slope(double t, const Values& y, Values& f) const;
  double piece(double h);
  double quickest() const;

  double mass_ = 0, radius_ = 0, damping_ = 0, t_ = 0;  ///< radius: of the outermost point [m]; t: since the outside forces were set [s]
  bool damped_ = false;
  int derivatives_ = 0;                     ///< highest order of derivatives of the outside forces
  std::array<Vec3, 4> force_;               ///< F and its derivatives
  std::array<Eigen::Matrix3d, 4> moments_;  ///< G and its derivatives
  Vec3 damped_arm_, inner_;
  Eigen::Matrix3d inverse_inertia_, damped_inertia_;
  Values y_;
};

}  // namespace softffd
