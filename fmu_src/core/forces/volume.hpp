/// The volume stiffness: what keeps crushed cells from folding. A lattice of springs has folded states without energy, into which it can
/// be pressed and in which it then stays; a penalty on the volumes J at the corners of its cells (cells.hpp) brings it back.
///
///      psi = sum over the corners with J < J0 of A phi(J),     phi = (J0 - J)^3 / (3 J0),     A = kappa V0 / 8,     J0 = 1/2,
///
/// kappa [Pa] being the volume stiffness and V0 [m3] the rest volume of a cell. While no corner has lost half its volume there is exactly
/// nothing; from there on the force grows with the square of what is missing, and stays finite where a corner is turned inside out. About
/// kappa = 3 k / a, k being a spring's stiffness and a a cell's edge, unfolds a box that was crushed to a twentieth of its height.
///
/// Hessian, per corner with the four points 0..3, g_i = dJ/dx_i and r_ij the distance between the two points other than i and j:
///
///      H_ij = A (phi'' g_i g_j^T + phi' C_ij),     phi'' = 2 (J0 - J) / J0 >= 0,     phi' = -(J0 - J)^2 / J0,
///
/// C_ij = d2J/dx_i dx_j, a skew matrix of norm r_ij / V0 for i /= j and 0 for i = j, for V0 J is a determinant of three differences,
/// linear in each point. The first part is positive semidefinite, and it is the stiffness that implicit methods take
/// (matrix/volume_hessian.hpp). For the
/// stability bound (stability.hpp) both are bounded, u being displacements of the points and m their masses: with
///
///      2 |p| |q| <= t |p|^2 + |q|^2 / t,     t = sqrt(m_i / m_j),
///
///      (sum g_i.u_i)^2              <= sum_i (g_i.u_i)^2 (sum_j |g_j| sqrt(m_i / m_j)) / |g_i|               (Cauchy and Schwarz),
///      |sum_(i /= j) u_i.C_ij u_j|  <= sum_i |u_i|^2 sum_(j /= i) (r_ij / V0) sqrt(m_i / m_j),
///
/// so that what a corner adds to the block S_p of its point p = i is
///
///      A (phi'' g_i g_i^T (sum_j |g_j| sqrt(m_i / m_j)) / |g_i| + |phi'| I sum_(j /= i) (r_ij / V0) sqrt(m_i / m_j)),
///
/// with pinned points j, which do not move, left out of the sums and none for a pinned i. Nothing bounds the Hessian in every
/// configuration: phi'' grows with the depth of the fold and g with the cell's faces.
#pragma once
#include <vector>

#include "forces/cells.hpp"

namespace softffd {

class Volume {
 public:
  /// Relative volume J0 from which on a corner resists.
  static constexpr double threshold = 0.5;

  /// kappa > 0 [Pa].
  Volume(const Lattice& lattice, double kappa);

  /// f += forces on the points at x [N], (points, 3).
  void add_force(const Points& x, Points& f) const;
  /// Energy at x [J].
  double energy(const Points& x) const;
  /// sums += the blocks S_p above at x [N/m], as xx yy zz xy xz yz, each (points). Returns whether there was anything to add.
  bool add_bounds(const Points& x, const Scalars& mass, const std::vector<bool>& pinned, Scalars& sums) const;

  /// Calls visit(corner, A phi'' [J]) for every corner that resists. Returns whether there was any.
  template <class Visit>
  bool visit_crushed(const Points& x, Visit visit) const {
    return cells_.visit_below(threshold, x, [&](const Cells::Corner& corner) { visit(corner, second(threshold - corner.volume)); });
  }

 private:
  double second(double missing) const { return scale_ * 2 * missing / threshold; }

  Cells cells_;
  double scale_;        ///< A [J]
  double rest_volume_;  ///< V0 [m3]
};

}  // namespace softffd
