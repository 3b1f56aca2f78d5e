/// The springs of the lattice (Xia & Wang 2009, figure 1 and eq. (6)), direction by direction.
///
/// A spring list with indices would gather and scatter. Here all springs of one direction are one row of lanes: lane p joins point p and
/// point p + offset, each spring once; lanes without a spring have stiffness 0. 13 rows hold all 468 springs of the 4 x 4 x 4 lattice:
///
///      p        0  1  2  3 | 4  5 ...        direction (1,0,0), offset 1
///      spring   *  *  *  . | *  *            '.': the neighbour is in the next line of points; k = 0
#pragma once
#include <vector>

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

class Springs {
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
  /// Whether there are any dashpots.
  bool dashpots() const { return longest_time_ > 0; }
  /// Largest ratio of a dashpot to its spring [s].
  double longest_time() const { return longest_time_; }
  /// The smallest, of all springs [s].
  double shortest_time() const { return shortest_time_; }

  /// f = spring forces on the points at x [N], (points, 3).
  void force(const Points& x, Points& f) const { pass_.force(x.data(), f.data()); }
  /// A stage by these forces and the outside ones [N] from x and v to the positions `next`, all (points, 3).
  void advance(const Stage& stage, const Points& outside, const Points& x, Points& v, Points& next) const {
    pass_.advance(stage, outside.data(), x.data(), v.data(), v.data(), next.data(), {});
  }
  /// The same from velocities `before` to v.
  void advance(const Stage& stage, const Points& outside, const Points& x, Points& before, Points& v, Points& next,
               const SpringPass::Between& between) const {
    pass_.advance(stage, outside.data(), x.data(), before.data(), v.data(), next.data(), between);
  }
  /// f -= C(x) v: what the dashpots exert on points at x that move with v, c ((v_b - v_a).u) u on the first point of a spring along the
  /// unit vector u, the opposite on the second. All (points, 3). A motion as a rigid body is not braked. With a drift [s] they go by the
  /// mean rate of their springs while all points go straight on for that time, or have come straight for it (negative): a spring that
  /// turns by the angle a grows by a^2 / 2 of its length on that way.
  void add_dashpot_force(const Points& x, const Points& v, Points& f, double drift = 0) const { add_dashpot_force(x, v, f.data(), drift); }
  void add_dashpot_force(const Points& x, const Points& v, double* f, double drift = 0) const {
    if (dashpots()) pass_.add_dashpot_force(x.data(), v.data(), drift, f);
  }
  /// That shares what the body has much of; null: nobody.
  /// Elastic energy at x [J].
  double energy(const Points& x) const;
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
  /// (6 * points), overwritten by every kernel call; the second half by those of bounds alone.
  double* scratch() const { return scratch_.data(); }

 private:
  void dashpots_changed();
  SpringPass::Rows views() const;

  Lattice lattice_;
  std::vector<Row> rows_;
  SpringPass pass_;
  double longest_time_ = 0, shortest_time_ = 0;
  mutable Scalars scratch_;
};

}  // namespace softffd
