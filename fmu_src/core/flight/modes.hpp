/// Vibration modes of a free body about its rest shape: eigenvectors of M^-1/2 K M^-1/2 without the six rigid motions, K being the Hessian
/// of the springs there. A stiff body in flight deforms so little that the modes hold; any length of time costs the same then.
///
/// Mode a moves the coordinate i = p + axis * points of a point, in the memory order of Points, by shape(i, a), with sum m shape^2 = 1. In
/// a frame that turns with Omega (body axes) Coriolis' force couples modes,
///
///      coupling a, b:   Omega . N_ab,     N_ab = sum over p of m_p shape_pb x shape_pa   (N_ba = -N_ab),
///
/// which matters only between modes of nearly the same frequency (Shabana 2013, Dynamics of Multibody Systems, section 5.3). If points are
/// damped unequally, modes of the same frequency are those that damping does not couple. Damping couples others by C = shape^T D shape,
/// which moves mode a by C_ab omega_b / |omega_a^2 - omega_b^2| of the amplitude of b, and by C_ab / C_bb at most, as b itself decays:
/// `uneven`.
#pragma once
#include "body/body.hpp"

namespace softffd {

struct Modes {
  /// Largest number of coordinates for which eigenvectors are computed: the time grows with its cube, 0.3 s at this number. Larger bodies
  /// have no modes here, and fly as rigid bodies.
  static constexpr int most_unknowns = 700;
  /// Number of neighbours in frequency to which a mode keeps its couplings.
  static constexpr int most_neighbours = 24;

  /// Computes the modes of a body with the rest positions `rest` (points, 3) [m], which may be placed anywhere.
  void make(const Body& body, const Points& rest);
  /// True if all motions but the six rigid ones are vibrations, or if the body is too large to compute them.
  bool valid() const { return valid_; }
  int count() const { return int(frequency.size()); }
  /// Returns N_ab for a < b <= a + most_neighbours.
  Vec3 coupling(int a, int b) const { return row(neighbours_, a * most_neighbours + b - a - 1); }

  Points arms;                ///< rest positions relative to the centre of mass [m]
  double mass = 0;            ///< [kg]
  double radius = 0;          ///< distance of the outermost point from the centre [m]
  Eigen::Matrix3d inertia;    ///< of the rest shape [kg m2]
  Scalars frequency, decay;   ///< (modes) omega [rad/s], ascending; rate at which damping reduces the amplitude [1/s]
  Eigen::MatrixXd shape;      ///< (3 * points, modes) [kg^-1/2]
  Eigen::MatrixXd excursion;  ///< (points, modes): largest displacement of a point by a mode of unit amplitude [kg^-1/2]
  bool damped_unevenly = false;
  Scalars uneven;  ///< (modes) largest displacement by other modes, which unequal damping excites from unit amplitude of this one [kg^-1/2]

 private:
  void find_uneven(const Scalars& damping);

  Points neighbours_;
  bool valid_ = false;
};

}  // namespace softffd
