/// Interface of the elastic energies of a body: an energy as a function of the positions of the points, and the dashpots that belong to
/// it. A body has a list of energies (body/body.hpp). All code that integrates, bounds or linearises goes through this list, so that a
/// new energy is one class. An energy must not change when the body moves as a whole, and its dashpots must not brake such a motion:
/// balances of momentum and flights rely on this.
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "forces/blocks.hpp"
#include "forces/fused_pass.hpp"
#include "model/types.hpp"

namespace softffd {

/// Receives the 3 x 3 blocks of a symmetric matrix of the points.
class BlockSink {
 public:
  virtual ~BlockSink() = default;
  /// Adds to the block of points p and q, passed in one order only, or, for p = q, to the symmetric block of one point [N/m].
  virtual void add(int p, int q, const Mat3& block) = 0;
};

/// Selects the matrix that is used for the second derivatives K at a state.
struct Linearisation {
  double softening = 0;  ///< weight of terms that may make K indefinite, from 0 (positive semidefinite) to 1 (all that the energy knows)
  double per_time = 0;   ///< factor of the dashpots' matrix C, which is added to K [1/s]
};

/// Bounds, for each point, of its contribution to the largest eigenvalue of K in every configuration [N/m]. There are two of them; each
/// is divided by the points' masses, and the one with the smaller maximum over the points counts (body/stability.hpp).
struct AnyBounds {
  Scalars weighted, plain;  ///< (points)
  bool exist = true;        ///< no configuration is stiffer than the bounds
};

/// Parameters of an estimate of how far vibrations move points.
struct Swing {
  const Scalars& time_scale;  ///< (3 * points) of the points (body/stability.hpp) [s]
  double slowest;             ///< points with at least this time scale are skipped [s]
  double times;               ///< number of time scales for which a velocity lasts [1]
  double dashpot_time;        ///< ratio of dashpot to stiffness [s]; above the time scale it shortens that duration
  bool with_extension;        ///< the extension counts too, which may be at rest

  /// Returns the time after which a velocity has been reversed, or taken by internal damping, and moves points no further [s].
  double reach(double time_scale) const { return times * time_scale / std::max(1.0, dashpot_time / time_scale); }
};

/// Largest relative displacement of pairs of points by vibrations [m]; infinite unless all values are finite.
class LargestSwing {
 public:
  explicit LargestSwing(const Swing& by) : by_(by) {}
  /// Takes points p and q into account, at x with velocities v; `length` is their distance at rest [m].
  void consider(int p, int q, double length, const Points& x, const Points& v) {
    const double time_scale = std::min(by_.time_scale[p], by_.time_scale[q]);
    if (time_scale >= by_.slowest) return;
    const Vec3 d = row(x, q) - row(x, p), w = row(v, q) - row(v, p);
    const double r = d.norm(), time = by_.reach(time_scale);
    if (by_.with_extension) take(std::abs(r - length));
    if (r == 0) return;
    take(std::abs(d.dot(w)) / r * time);
    take(w.squaredNorm() / r * time * time);
  }
  double value() const { return std::isfinite(sum_) ? most_ : std::numeric_limits<double>::infinity(); }

 private:
  void take(double size) {
    most_ = std::max(most_, size);
    sum_ += size;
  }
  const Swing& by_;
  double most_ = 0, sum_ = 0;  ///< the sum is not finite if any value is not
};

class Energy {
 public:
  virtual ~Energy() = default;

  /// Returns the energy at x, (points, 3) [J].
  virtual double energy(const Points& x) const = 0;
  /// f += forces on the points at x [N], both (points, 3).
  virtual void add_force(const Points& x, Points& f) const = 0;
  /// f = forces on the points at x [N].
  virtual void set_force(const Points& x, Points& f) const {
    f.setZero();
    add_force(x, f);
  }

  /// Passes the matrix of the linearisation at x to the sink, block by block.
  virtual void add_blocks(const Points& x, const Linearisation& of, BlockSink& sink) const = 0;
  /// f -= the same matrix times u [N]; u [m], (points, 3).
  virtual void subtract_product(const Points& x, const Linearisation& of, const Points& u, Points& f) const = 0;
  /// Return the largest stiffness between two points, and the sum of all stiffnesses [N/m].
  virtual double largest_stiffness() const { return 0; }
  virtual double total_stiffness() const { return 0; }

  /// Adds to the bounds that hold in every configuration, for points of these masses [kg]; pinned points have no bound. Must be called
  /// before add_bounds whenever masses, stiffness or pins have changed.
  virtual void add_any_bounds(const Scalars& mass, const std::vector<bool>& pinned, AnyBounds& bounds) const = 0;
  /// sums += blocks S_p that bound K at x (body/stability.hpp) [N/m], as xx yy zz xy xz yz, each (points). Returns true if the blocks may
  /// exceed the bounds of add_any_bounds.
  virtual bool add_bounds(const Points& x, const Scalars& mass, const std::vector<bool>& pinned, Scalars& sums) const = 0;
  /// True if the points have moved so far from x0 to x that the bounds at x0 no longer serve at x.
  virtual bool has_deformed(const Points& x, const Points& x0) const = 0;
  /// Returns how far the energy's vibrations move points that are at x with velocities v [m]; infinite unless all values are finite.
  virtual double swing(const Points& x, const Points& v, const Swing& by) const = 0;
  /// Returns the number of cells that are inverted by a criterion of this energy, other than the volumes at their corners (cells.hpp).
  virtual int folded_cells(const Points&) const { return 0; }
  /// True if a force between two points has no direction, because their positions and velocities are equal.
  virtual bool undecided(const Points&, const Points&, const std::vector<bool>&) const { return false; }

  /// Whether the energy has dashpots; the smallest and the largest ratio of a dashpot to its stiffness [s].
  bool dashpots() const { return longest_time() > 0; }
  virtual double shortest_time() const { return 0; }
  virtual double longest_time() const { return 0; }
  /// f -= C(x) v: adds the dashpot forces on points at x with velocities v, all (points, 3). Rigid motions are not braked. With a drift
  /// [s] the forces follow from the mean rate of the dashpots' lengths while all points move on in straight lines for that time, or, if
  /// it is negative, have moved so until now.
  virtual void add_dashpot_force(const Points&, const Points&, Points&, double = 0) const {}
  /// Returns the power that the dashpots dissipate at positions x and velocities v [W].
  virtual double dashpot_power(const Points&, const Points&) const { return 0; }
  /// Returns a bound of the rate at which the dashpots change velocities at x [1/s]; 0 if longest_time() times the largest squared
  /// frequency in any configuration is such a bound.
  virtual double dashpot_rate(const Points&, const Scalars&, const std::vector<bool>&) const { return 0; }

  /// Returns a pass that computes the forces and moves the points as well, or null if there is none; the pass knows no dashpots.
  virtual const FusedPass* fused() const { return nullptr; }
};

}  // namespace softffd
