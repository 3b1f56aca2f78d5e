/// The body as a finite-element solid of patches of 4 x 4 x 4 nodes (model/lobatto.hpp). The deformation of each patch is the cubic
/// Bezier volume of its control points. The material is stable neo-Hookean (Smith, de Goes and Kim 2018, without their last term). Its
/// volumetric part is projected onto products of linear functions in each patch, so that nothing locks as Poisson's ratio approaches 1/2
/// (Maday and Patera 1989):
///
///      sum over nodes of w (mu/2 (I - 3) - mu q + mu/2 q^2) + lambda/2 sum of w (Pi q)^2 + lambda/(3 J0) sum of w max(0, J0 - J)^3,
///
///      F = dx/dX,  I = |F|^2,  J = det F,  q = J - 1,  mu = E / 2(1 + nu),  lambda = E nu / (1 + nu)(1 - 2 nu),  J0 = 0.3,
///
/// where w are the quadrature weights at the nodes. For small strains this is mu e:e + lambda/2 (tr e)^2: Young's modulus and Poisson's
/// ratio are exact. The last term acts where a node has lost 70 % of its volume; the projection alone would let the node invert.
///
/// Internal damping is of Kelvin-Voigt type: the second Piola-Kirchhoff stress is time (2 mu E' + lambda Pi(tr E') 1), where E' is the
/// rate of Green's strain. Its matrix at rest is `time` times the stiffness. Rigid motions are not damped.
///
/// The frequency is bounded patch by patch, with K = sum of K_e and M = sum of M_e. Let H be the gradient of a displacement u, c = cof F,
/// c0 the mean of c, s = dpsi/dJ, and k the coefficient of (c:H)^2 at a node. The part of a patch is then
///
///      u'Ku = sum of w (mu |H|^2 + k (c:H)^2 + s H:(dc/dF):H) + lambda sum of w (Pi c:H)^2
///          <= (L max alpha + lambda (sqrt(L max |c - c0|^2) + sqrt(D |c0|_2^2))^2) sum of w |u|^2.
///
/// where alpha is the largest eigenvalue of mu 1 + k c c' + s dc/dF, bounded by its invariants: in the principal axes of F it is mu plus
/// the largest eigenvalue of k c c' + s M with M_ij = sigma_k, or mu + |s| sigma. L and D are the largest eigenvalues of sum w |H|^2 and
/// of sum w (Pi div u)^2 in the metric of w. For sides a, b, c they are
///
///      L = (42 + sqrt 1044) (1/a^2 + 1/b^2 + 1/c^2),      D = 60 (1/a^2 + 1/b^2 + 1/c^2),
///
/// and c0:H = div(c0'u). Let r be the smallest ratio of mass to volume (the weight of the quadrature) among the moving nodes of a patch.
/// The squared frequency of the patch is then at most 1/r times the bound above. The same bound with F in place of c applies to the
/// dashpots. No bound holds in every configuration.
#pragma once
#include <array>
#include <memory>
#include <vector>

#include "forces/energy.hpp"
#include "forces/lattice_edges.hpp"
#include "forces/solid_kernels.hpp"

namespace softffd {

/// A place in a solid: its patch, and the values and slopes of the nodes' polynomials at this place along each axis.
struct SolidPlace {
  /// at: the place at rest, in the box [m].
  SolidPlace(const Lattice& lattice, const Vec3& at);
  std::array<int, 3> patch;
  std::array<std::array<double, 4>, 3> value, slope;  ///< [1], [1/m]
  Vec3 from_middle;                                   ///< position in the patch, whose ends are at -1 and 1 along each axis
};

/// State of the material at a place.
struct MaterialState {
  Mat3 gradient;  ///< deformation gradient F [1]
  Mat3 stress;    ///< Cauchy stress of the energy [Pa]; NaN where det F <= 0
  double von_mises() const;
  double largest_stretch() const;
};

class Solid final : public Energy {
 public:
  /// lattice: must consist of whole patches.
  explicit Solid(const Lattice& lattice);

  /// Young's modulus > 0 [Pa], Poisson's ratio from 0 to below 1/2 [1], time of the internal damping >= 0 [s].
  void set_material(double modulus, double ratio, double time);

  double energy(const Points& x) const override { return kernels::solid_energy(body_, x.data()); }
  void add_force(const Points& x, Points& f) const override;
  void add_blocks(const Points& x, const Linearisation& of, BlockSink& sink) const override;
  void subtract_product(const Points& x, const Linearisation& of, const Points& u, Points& f) const override;
  double largest_stiffness() const override;
  double total_stiffness() const override;

  void add_any_bounds(const Scalars& mass, const std::vector<bool>& pinned, AnyBounds& bounds) const override;
  bool add_bounds(const Points& x, const Scalars& mass, const std::vector<bool>& pinned, Scalars& sums) const override;
  bool has_deformed(const Points& x, const Points& x0) const override { return edges_.changed(x, x0, deformation); }
  double swing(const Points& x, const Points& v, const Swing& by) const override;

  /// Returns the number of cells with a node where J <= 0.
  int folded_cells(const Points& x) const override;

  double shortest_time() const override { return time_; }
  double longest_time() const override { return time_; }
  void add_dashpot_force(const Points& x, const Points& v, Points& f, double drift = 0) const override;
  double dashpot_power(const Points& x, const Points& v) const override;
  /// Returns the state of the material at a place, with the nodes at x.
  MaterialState at(const SolidPlace& place, const Points& x) const;

  double dashpot_rate(const Points& x, const Scalars& mass, const std::vector<bool>& pinned) const override;

 private:
  /// If the vector between neighbours changes by more than this fraction of its length at rest, bounds are computed anew [1].
  static constexpr double deformation = 0.05;

  /// Returns the largest value over all patches of squared(bounds of the patch) divided by the smallest density of its moving nodes.
  template <class Squared>
  double largest(const Points& x, const Scalars& mass, const std::vector<bool>& pinned, const Squared& squared) const;
  double density(int patch, const Scalars& mass, const std::vector<bool>& pinned) const;
  void keep_gradients(const Points& x) const;
  /// Returns the lowest node number of a patch.
  int first_node(int patch) const;
  double squared_frequency(const kernels::PatchBounds& bounds) const;

  Lattice lattice_;
  kernels::SolidBody body_;
  LatticeEdges edges_;
  Points rest_;
  Scalars volume_;                ///< (points) sum of w at each node [m3]
  double gradient_, divergence_;  ///< L, D [1/m2]
  double time_ = 0;               ///< time of the internal damping [s]
  mutable std::vector<kernels::PatchBounds> bounds_;
  mutable Points kept_at_;                                ///< with internal damping: the last positions [m]
  mutable Scalars kept_;                                  ///< F at these positions, patch by patch
  mutable std::unique_ptr<kernels::PatchMatrix> matrix_;  ///< allocated when first needed
};

}  // namespace softffd
