/// Bounds on the highest angular frequency of the lattice, and with them the largest stable explicit step 2 / omega.
///
/// For a vector x of point displacements the springs' Hessian K satisfies
///
///      x'Kx <= sum_e (x_a - x_b)' B_e (x_a - x_b),      B_e = k (u u^T + max(0, 1 - l/r) (I - u u^T)) >= Hessian of spring e,
///
/// and, with t = sqrt(m_a / m_b), (p - q)'B(p - q) <= (1 + t) p'Bp + (1 + 1/t) q'Bq. Collected point by point this is block diagonal:
///
///      omega^2 <= max_p lambda_max(S_p) / m_p,      S_p = sum over the springs at p of (1 + sqrt(m_p / m_other)) B_e.
///
/// A pinned neighbour does not move: its term is B_e alone. Replacing B_e by k I gives a bound that holds in any configuration, because
/// no eigenvalue of a spring's Hessian exceeds k. A power iteration would approach omega from below, the wrong side.
///
/// Every energy of the body adds its own blocks to S_p; a volume stiffness (derived in volume.hpp) adds nothing while no corner has lost
/// half its volume. With a volume stiffness no bound holds in every configuration: a step that was stable may become unstable when the
/// next cell inverts. The bound of the state has to be renewed as the body deforms, more often than without it.
#pragma once
#include "body/body.hpp"

namespace softffd {

class Stability {
 public:
  explicit Stability(int points) : sums_(6 * points), mean_(points), spread_(points) {}

  /// Recomputes the quantities that depend on masses and stiffness alone.
  void prepare(const Body& body);
  /// Returns an upper bound of omega at configuration x [rad/s].
  double frequency(const Body& body, const Points& x) const;
  /// Returns the largest leapfrog step at x that is stable by the bound [s]; the largest finite number if nothing resists deformation.
  double stable_step(const Body& body, const Points& x) const;
  /// Sets `scales` to the time in which a velocity error of a point becomes a position error, (3 * points) [s]: about a period of the
  /// springs at the point over 2 pi, for the uniform lattice the inverse of the geometric mean of its lowest and highest frequency.
  void time_scales(const Body& body, Scalars& scales) const;
  /// Returns an upper bound of omega in every configuration, for the energies that have one [rad/s].
  double any_frequency() const { return any_frequency_; }
  /// True if the body resists deformation at all; if not, its frequency is 0 in any shape.
  bool elastic() const { return elastic_; }

 private:
  AnyBounds any_;                  ///< bounds in every configuration
  mutable Scalars sums_;           ///< S_p as xx yy zz xy xz yz, each (points)
  mutable Scalars mean_, spread_;  ///< workspace (points)
  double any_frequency_ = 0;
  bool elastic_ = false;
};

}  // namespace softffd
