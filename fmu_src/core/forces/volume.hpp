/// The volume stiffness, which keeps crushed cells from inverting. A lattice of springs has inverted states without energy, into which it
/// can be pressed and in which it then stays. A penalty on the volumes J at the corners of the cells (cells.hpp) brings it back.
///
///      psi = sum over the corners with J < J0 of A phi(J),     phi = (J0 - J)^3 / (3 J0),     A = kappa V0 / 8,     J0 = 1/2,
///
/// where kappa [Pa] is the volume stiffness and V0 [m3] the rest volume of a cell. While no corner has lost half its volume, the penalty
/// is exactly 0. Beyond that the force grows with the square of the missing volume J0 - J, and stays finite where a corner is inverted.
/// About kappa = 3 k / a, with k a spring's stiffness and a a cell's edge, restores a box that was crushed to a twentieth of its height.
///
/// The Hessian of a corner with the four points 0..3, g_i = dJ/dx_i and r_ij the distance between the two points other than i and j, is
///
///      H_ij = A (phi'' g_i g_j^T + phi' C_ij),     phi'' = 2 (J0 - J) / J0 >= 0,     phi' = -(J0 - J)^2 / J0,
///
/// where C_ij = d2J/dx_i dx_j is a skew matrix of norm r_ij / V0 for i /= j and 0 for i = j, because V0 J is a determinant of three
/// differences, linear in each point. The first part is positive semidefinite; implicit methods take it as the stiffness (add_blocks).
/// For the stability bound (stability.hpp) both parts are bounded, for displacements u of the points and their masses m, by means of
///
///      2 |p| |q| <= t |p|^2 + |q|^2 / t,     t = sqrt(m_i / m_j),
///
///      (sum g_i.u_i)^2              <= sum_i (g_i.u_i)^2 (sum_j |g_j| sqrt(m_i / m_j)) / |g_i|               (Cauchy and Schwarz),
///      |sum_(i /= j) u_i.C_ij u_j|  <= sum_i |u_i|^2 sum_(j /= i) (r_ij / V0) sqrt(m_i / m_j),
///
/// so that a corner adds to the block S_p of its point p = i
///
///      A (phi'' g_i g_i^T (sum_j |g_j| sqrt(m_i / m_j)) / |g_i| + |phi'| I sum_(j /= i) (r_ij / V0) sqrt(m_i / m_j)),
///
/// where pinned points j, which do not move, are left out of the sums, and a pinned i has no block. No bound of the Hessian holds in
/// every configuration: phi'' grows with the depth of the inversion and g with the cell's faces.
#pragma once
#include <limits>
#include <vector>

#include "forces/cells.hpp"
#include "forces/energy.hpp"
#include "forces/lattice_edges.hpp"

namespace softffd {

class Volume final : public Energy {
 public:
  /// A corner resists if its relative volume is below this J0 [1].
  static constexpr double threshold = 0.5;

  /// kappa > 0 [Pa].
  Volume(const Lattice& lattice, double kappa);

  double energy(const Points& x) const override;
  void add_force(const Points& x, Points& f) const override;
  /// Adds the positive semidefinite part of the Hessian: A phi'' g g^T of every corner that resists.
  void add_blocks(const Points& x, const Linearisation& of, BlockSink& sink) const override;
  void subtract_product(const Points& x, const Linearisation& of, const Points& u, Points& f) const override;
  void add_any_bounds(const Scalars&, const std::vector<bool>&, AnyBounds& bounds) const override { bounds.exist = false; }
  bool add_bounds(const Points& x, const Scalars& mass, const std::vector<bool>& pinned, Scalars& sums) const override;
  /// Compares the edges of the cells.
  bool has_deformed(const Points& x, const Points& x0) const override { return edges_.changed(x, x0, deformation); }
  /// Returns 0: where corners resist, the motion shows in the springs beside this energy.
  double swing(const Points&, const Points&, const Swing&) const override { return 0; }
  /// Infinite, because the other energies provide the internal damping.
  double shortest_time() const override { return std::numeric_limits<double>::infinity(); }

 private:
  /// If an edge's vector changes by more than this fraction of its length at rest, the stability bound is computed anew [1]: the
  /// stiffness grows fast once a corner begins to invert.
  static constexpr double deformation = 0.05;

  /// Calls visit(corner, A phi'' [J]) for every corner that resists. Returns whether there was any.
  template <class Visit>
  bool visit_crushed(const Points& x, Visit visit) const {
    return cells_.visit_below(threshold, x, [&](const Cells::Corner& corner) { visit(corner, second(threshold - corner.volume)); });
  }
  double second(double missing) const { return scale_ * 2 * missing / threshold; }

  Cells cells_;
  double scale_;        ///< A [J]
  double rest_volume_;  ///< V0 [m3]
  LatticeEdges edges_;
};

}  // namespace softffd
