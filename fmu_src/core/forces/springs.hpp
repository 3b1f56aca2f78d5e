/// The springs of the lattice (Xia & Wang 2009, figure 1 and eq. (6)), direction by direction.
///
/// A list of springs with indices would need gathers and scatters. Here all springs of one direction form one row of lanes: lane p joins
/// points p and p + offset, each spring once. Lanes without a spring have stiffness 0. 13 rows hold all 468 springs of 4 x 4 x 4 points:
///
///      p        0  1  2  3 | 4  5 ...        direction (1,0,0), offset 1
///      spring   *  *  *  . | *  *            '.': the neighbour is in the next line of points; k = 0
#pragma once
#include <vector>

#include "forces/energy.hpp"
#include "forces/kernels.hpp"
#include "forces/spring_pass.hpp"
#include "model/lattice.hpp"

namespace softffd {

enum class Topology {
  distinct,  ///< every pair once: 468 springs for 4 x 4 x 4
  paper      ///< face by face as published: the segments on the twelve edges of the box are doubled (504)
};

struct Stiffness {
  double edge = 0, face = 0, body = 0;  ///< >= 0 [N/m]
  double of(SpringKind kind) const { return kind == SpringKind::edge ? edge : kind == SpringKind::face ? face : body; }
  bool operator==(const Stiffness&) const = default;
};

/// Gives the springs with both ends among the selected points a value of their own; later overrides win.
struct SpringOverride {
  std::vector<bool> selected;  ///< (points)
  double value;                ///< >= 0, stiffness [N/m] or time of the dashpots [s]
};

class Springs final : public Energy, public FusedPass {
 public:
  /// team: the threads that compute the forces; null: the calling thread computes them.
  Springs(const Lattice& lattice, Topology topology, std::shared_ptr<Team> team = nullptr);

  void set_stiffness(const Stiffness& stiffness, const std::vector<SpringOverride>& overrides);
  /// Sets a dashpot along each spring, of the spring's stiffness times this time >= 0 [s]: the material's internal damping. Must be
  /// called after the stiffness is set.
  void set_dashpots(double time, const std::vector<SpringOverride>& overrides = {});
  /// Sets springs along the edges and face diagonals of the cells, so that cells of this modulus [Pa], (cells), make an isotropic solid
  /// of Poisson's ratio 1/4. With sides a, b, c of a cell and its volume V, a cell contributes
  ///
  ///      1/4 of   (V / a^2) E (1.2 - 0.4 a^2 / b^2 - 0.4 a^2 / c^2)     to each of its four edges along a
  ///      1/2 of   0.2 E V (a^2 + b^2) / (a^2 b^2)                       to each diagonal of its two faces of sides a and b
  ///
  /// so that homogeneous strains have the solid's energy. A spring that several cells share has the sum of their stiffnesses. None is
  /// negative while a^2 / b^2 + a^2 / c^2 <= 3 for each side a. Its dashpot is the same sum, each part times its cell's time [s], which
  /// is >= 0 (cells).
  void set_modulus(const Scalars& modulus, const Scalars& time);
  double longest_time() const override { return longest_time_; }
  double shortest_time() const override { return shortest_time_; }

  double energy(const Points& x) const override;
  void add_force(const Points& x, Points& f) const override;
  void set_force(const Points& x, Points& f) const override { pass_.force(x.data(), f.data()); }
  const FusedPass* fused() const override { return this; }
  using FusedPass::advance;
  void advance(const Stage& stage, const Points& outside, const Points& x, Points& before, Points& v, Points& next,
               const Between& between) const override {
    pass_.advance(stage, outside.data(), x.data(), before.data(), v.data(), next.data(), between);
  }
  /// The second derivatives are one matrix per spring, to which its dashpot adds c per_time u u^T:
  ///
  ///      k (u u^T + e (I - u u^T)),  e = 1 - l/r,      u: unit vector along the spring, r its length, l its rest length.
  ///
  /// A compressed spring has e < 0, which softens it across its direction and may make the sum indefinite. The linearisation multiplies a
  /// negative e by its `softening`. At softening 0 each matrix is the nearest positive semidefinite one, with which Newton's method
  /// converges slowly under compression. At r = 0, where there is no direction, the matrix is then 0.
  void add_blocks(const Points& x, const Linearisation& of, BlockSink& sink) const override;
  void subtract_product(const Points& x, const Linearisation& of, const Points& u, Points& f) const override;
  double largest_stiffness() const override;
  double total_stiffness() const override;
  void add_any_bounds(const Scalars& mass, const std::vector<bool>& pinned, AnyBounds& bounds) const override;
  bool add_bounds(const Points& x, const Scalars& mass, const std::vector<bool>& pinned, Scalars& sums) const override;
  bool has_deformed(const Points& x, const Points& x0) const override;
  /// Considers the extension of each spring, its rate, and what rotation of the spring adds to the extension.
  double swing(const Points& x, const Points& v, const Swing& by) const override;
  /// True if a spring without length would push its ends apart in whatever direction rounding gives it.
  bool undecided(const Points& x, const Points& v, const std::vector<bool>& pinned) const override;
  /// Adds c ((v_b - v_a).u) u to the first point of a spring along the unit vector u, the opposite to the second. During a drift a spring
  /// that turns by the angle a grows by a^2 / 2 of its length.
  void add_dashpot_force(const Points& x, const Points& v, Points& f, double drift = 0) const override {
    if (dashpots()) pass_.add_dashpot_force(x.data(), v.data(), drift, f.data());
  }
  double dashpot_power(const Points& x, const Points& v) const override;
  /// Returns the number of springs; a doubled segment counts twice.
  int count() const;

  struct Row {
    Direction direction;
    int begin, offset;
    Scalars multiplicity;  ///< 0 (none), 1 or 2 (lanes)
    Scalars stiffness;     ///< [N/m] (lanes)
    Scalars rest_length;   ///< [m] (lanes)
    Scalars dashpot;       ///< c [N s/m] (lanes); empty if no spring has a dashpot
    int lanes() const { return int(stiffness.size()); }
    /// Returns the value of the last override for the spring in a lane, or `value` if there is none.
    double overridden(int lane, double value, const std::vector<SpringOverride>& overrides) const;
    kernels::SpringRow view() const { return {begin, lanes(), offset, stiffness.data(), rest_length.data()}; }
  };
  const std::vector<Row>& rows() const { return rows_; }

 private:
  /// If an edge's vector changes by more than this fraction of its rest length, the stability bound is computed anew [1]. A smaller value
  /// costs more bounds, a larger one keeps outdated bounds. By experience the distance of chosen steps from the bound covers the change.
  static constexpr double deformation = 0.2;

  void dashpots_changed();
  SpringPass::Rows views() const;
  /// Returns c if there are dashpots, else as many arbitrary numbers.
  const double* dashpots_of(const Row& row) const { return (dashpots() ? row.dashpot : row.stiffness).data(); }

  Lattice lattice_;
  std::vector<Row> rows_;
  SpringPass pass_;
  double longest_time_ = 0, shortest_time_ = 0;
  /// k (1 + sqrt(mass ratio)) of each row's lanes, as seen from either end, for the masses of the last call of add_any_bounds.
  mutable std::array<Scalars, directions.size()> first_, second_;
  mutable Scalars block_, sums_;  ///< (6 * points) scratch: values of a row's springs, lane by lane; sums at each point
};

}  // namespace softffd
