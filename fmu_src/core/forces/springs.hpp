/// The springs of the lattice (Xia & Wang 2009, figure 1 and eq. (6)), direction by direction.
///
/// A spring list with indices would gather and scatter. Here all springs of one direction are one row of lanes: lane p joins point p and
/// point p + offset, each spring once; lanes without a spring have stiffness 0. 13 rows hold all 468 springs of the 4 x 4 x 4 lattice:
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

/// Springs with both ends among the points have a value of their own; later overrides win.
struct SpringOverride {
  std::vector<bool> selected;  ///< (points)
  double value;                ///< >= 0, stiffness [N/m] or time of the dashpots [s]
};

class Springs final : public Energy, public FusedPass {
 public:
  /// The forces are worked out by this team; null: by the thread that asks for them.
  Springs(const Lattice& lattice, Topology topology, std::shared_ptr<Team> team = nullptr);

  void set_stiffness(const Stiffness& stiffness, const std::vector<SpringOverride>& overrides);
  /// A dashpot along each spring, of its stiffness times this time [s], >= 0: the material's internal damping. After the stiffness.
  void set_dashpots(double time, const std::vector<SpringOverride>& overrides = {});
  /// Springs that make an isotropic solid of Poisson's ratio 1/4 of cells of this modulus [Pa], (cells), which are springs of the sides and
  /// the face diagonals. With sides a, b, c of a cell and its volume V, a cell gives
  ///
  ///      1/4 of   (V / a^2) E (1.2 - 0.4 a^2 / b^2 - 0.4 a^2 / c^2)     to each of its four edges along a
  ///      1/2 of   0.2 E V (a^2 + b^2) / (a^2 b^2)                       to each diagonal of its two faces of sides a and b
  ///
  /// so that homogeneous strains have the solid's energy; springs that several cells share have the sum. None is < 0 while
  /// a^2 / b^2 + a^2 / c^2 <= 3 for each side a. Their dashpots are the same sum, each part times its cell's time [s], >= 0 (cells).
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
  /// The second derivatives are one matrix a spring, to which its dashpot adds c per_time u u^T,
  ///
  ///      k (u u^T + e (I - u u^T)),  e = 1 - l/r,      u: unit vector along the spring, r its length, l its rest length.
  ///
  /// A compressed spring has e < 0, which softens it across and may make the sum indefinite: of this the linearisation takes its share.
  /// With none each matrix is the nearest positive semidefinite one, with which Newton's method converges slowly under compression. At
  /// r = 0, where there is no direction, there is nothing then.
  void add_blocks(const Points& x, const Linearisation& of, BlockSink& sink) const override;
  void subtract_product(const Points& x, const Linearisation& of, const Points& u, Points& f) const override;
  double largest_stiffness() const override;
  double total_stiffness() const override;
  void add_any_bounds(const Scalars& mass, const std::vector<bool>& pinned, AnyBounds& bounds) const override;
  bool add_bounds(const Points& x, const Scalars& mass, const std::vector<bool>& pinned, Scalars& sums) const override;
  bool has_deformed(const Points& x, const Points& x0) const override;
  /// By the springs' extension, its rate, and what turning adds to it.
  double swing(const Points& x, const Points& v, const Swing& by) const override;
  /// Springs without length would push their ends apart, if rounding gave them a direction.
  bool undecided(const Points& x, const Points& v, const std::vector<bool>& pinned) const override;
  /// c ((v_b - v_a).u) u on the first point of a spring along the unit vector u, the opposite on the second. On a drift a spring that turns
  /// by the angle a grows by a^2 / 2 of its length.
  void add_dashpot_force(const Points& x, const Points& v, Points& f, double drift = 0) const override {
    if (dashpots()) pass_.add_dashpot_force(x.data(), v.data(), drift, f.data());
  }
  double dashpot_power(const Points& x, const Points& v) const override;
  /// Number of springs; a doubled segment counts twice.
  int count() const;

  struct Row {
    Direction direction;
    int begin, offset;
    Scalars multiplicity;  ///< 0 (none), 1 or 2 (lanes)
    Scalars stiffness;     ///< [N/m] (lanes)
    Scalars rest_length;   ///< [m] (lanes)
    Scalars dashpot;       ///< c [N s/m] (lanes); none where no spring has one
    int lanes() const { return int(stiffness.size()); }
    /// A value of the spring in a lane, that of the last override for it if there is one.
    double overridden(int lane, double value, const std::vector<SpringOverride>& overrides) const;
    kernels::SpringRow view() const { return {begin, lanes(), offset, stiffness.data(), rest_length.data()}; }
  };
  const std::vector<Row>& rows() const { return rows_; }

 private:
  /// Change of an edge's vector relative to its rest length from which on the stability bound is computed anew [1]. Smaller: more bounds to
  /// compute; larger: the bound of a state that has gone. By experience the distance that chosen steps keep from the bound covers it.
  static constexpr double deformation = 0.2;

  void dashpots_changed();
  SpringPass::Rows views() const;
  /// c where there are dashpots; else any numbers, as many.
  const double* dashpots_of(const Row& row) const { return (dashpots() ? row.dashpot : row.stiffness).data(); }

  Lattice lattice_;
  std::vector<Row> rows_;
  SpringPass pass_;
  double longest_time_ = 0, shortest_time_ = 0;
  /// k (1 + sqrt(mass ratio)) of each row's lanes, as seen from either end, of the masses that bounds were last asked for.
  mutable std::array<Scalars, directions.size()> first_, second_;
  mutable Scalars block_, sums_;  ///< (6 * points): of the springs of a row, lane by lane; of all at a point
};

}  // namespace softffd
