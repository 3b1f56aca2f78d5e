/// Vibrations of a free body about its rest shape: eigenvectors of M^-1/2 K M^-1/2, K being the springs' Hessian there, without the six
/// rigid motions. A stiff body that flies deforms so little that they hold, and with them any length of time costs the same.
///
/// Of a point's coordinate i = p + axis * points, as Points has them in memory, mode a moves shape(i, a), with sum m shape^2 = 1. In a
/// frame that turns with Omega (body axes) modes feel each other through Coriolis' force,
///
///      coupling a, b:   Omega . N_ab,     N_ab = sum over p of m_p shape_pb x shape_pa   (N_ba = -N_ab),
///
/// which matters between modes of nearly the same frequency alone (Shabana 2013, Dynamics of Multibody Systems, section 5.3). Where points
/// are damped unequally, modes of the same frequency are those that damping does not couple; what it does to others, C = shape^T D shape,
/// moves mode a by C_ab omega_b / |omega_a^2 - omega_b^2| of the amplitude of b, and by C_ab / C_bb at most, as b itself fades: `uneven`.
#pragma once
#include "body/body.hpp"

namespace softffd {

struct Modes {
  /// Coordinates of the points above which the eigenvectors cost too much, as their time grows with the cube, 0.3 s for these: larger
  /// bodies have no modes here, and fly as rigid ones.
  static constexpr int most_unknowns = 700;
  /// Neighbours in frequency that couplings are kept for.
  static constexpr int most_neighbours = 24;

  /// Of this body, whose rest positions these are; `rest` may be placed anywhere.
  void make(const Body& body, const Points& rest);
  /// Whether the body vibrates in all ways but the rigid ones, or is too large to say.
  bool valid() const { return valid_; }
  int count() const { return int(frequency.size()); }
  /// N_ab for a < b <= a + most_neighbours.
  Vec3 coupling(int a, int b) const { return row(neighbours_, a * most_neighbours + b - a - 1); }

  Points arms;                ///< rest positions from the centre of mass [m]
  double mass = 0;            ///< [kg]
  double radius = 0;          ///< of the outermost point [m]
  Eigen::Matrix3d inertia;    ///< of the rest shape [kg m2]
  Scalars frequency, decay;   ///< omega [rad/s], ascending, and the rate at which damping takes the amplitude [1/s], (modes)
  Eigen::MatrixXd shape;      ///< (3 * points, modes) [kg^-1/2]
  Eigen::MatrixXd excursion;  ///< (points, modes): largest way of a point in a mode of unit amplitude [kg^-1/2]
  bool damped_unevenly = false;
  Scalars uneven;  ///< (modes) how far unequal damping moves a point by another mode, of unit amplitude of this one, at most [kg^-1/2]

 private:
  void find_uneven(const Scalars& damping);

  Points neighbours_;
  bool valid_ = false;
};

}  // namespace softffd
