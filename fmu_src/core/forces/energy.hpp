/// What holds a body together: an energy of the positions of its points, and the dashpots that go with it. A body has a list of these
/// (body/body.hpp), and all that integrates, bounds or linearises asks the list: a new energy is one class. It may not change where the
/// body moves as a whole, nor may its dashpots brake that: balances of momentum and flights rest on it.
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "forces/blocks.hpp"
#include "forces/fused_pass.hpp"
#include "model/types.hpp"

namespace softffd {

/// Takes the 3 x 3 blocks of a symmetric matrix of the points.
class BlockSink {
 public:
  virtual ~BlockSink() = default;
  /// += the block of two points, handed over in one order alone; or that of one point, which is symmetric [N/m].
  virtual void add(int p, int q, const Mat3& block) = 0;
};

/// Which matrix stands for the second derivatives K at a state.
struct Linearisation {
  double softening = 0;  ///< of what may make K indefinite, from 0 (positive semidefinite) to 1 (all that the energy knows)
  double per_time = 0;   ///< times the dashpots' matrix C is added [1/s]
};

/// For each point a bound of what it contributes to the largest eigenvalue of K in every configuration [N/m]; twice, the smaller largest of
/// which, by the points' masses, counts (body/stability.hpp).
struct AnyBounds {
  Scalars weighted, plain;  ///< (points)
  bool exist = true;        ///< nothing is stiffer than that in any configuration
};

/// By what a motion is judged that vibrations of points may have.
struct Swing {
  const Scalars& time_scale;  ///< (3 * points) [s]
  double slowest;             ///< points of a time scale from this one on are passed over [s]
  double times;               ///< a velocity lasts for so many time scales [1],
  double dashpot_time;        ///< unless dashpots of this time take it [s]
  bool with_extension;        ///< what may be at rest counts too

  /// Time in which a velocity is turned round, or internal damping has taken it: then it moves points no further [s].
  double reach(double time_scale) const { return times * time_scale / std::max(1.0, dashpot_time / time_scale); }
};

/// The largest way that pairs of points swing [m]; infinite unless all is finite.
class LargestSwing {
 public:
  explicit LargestSwing(const Swing& by) : by_(by) {}
  /// Of p and q, which are as far apart at rest as `length` [m], at x, that move with v.
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
  double most_ = 0, sum_ = 0;  ///< the sum shows what is not finite
};

class Energy {
 public:
  virtual ~Energy() = default;

  /// At x, (points, 3) [J].
  virtual double energy(const Points& x) const = 0;
  /// f += forces on the points at x [N], both (points, 3).
  virtual void add_force(const Points& x, Points& f) const = 0;
  /// f = these.
  virtual void set_force(const Points& x, Points& f) const {
    f.setZero();
    add_force(x, f);
  }

  /// The matrix of the linearisation at x, block by block.
  virtual void add_blocks(const Points& x, const Linearisation& of, BlockSink& sink) const = 0;
  /// f -= the same matrix times u [N]; u [m], (points, 3).
  virtual void subtract_product(const Points& x, const Linearisation& of, const Points& u, Points& f) const = 0;
  /// Stiffness [N/m]: the largest between two points, and the sum of all.
  virtual double largest_stiffness() const { return 0; }
  virtual double total_stiffness() const { return 0; }

  /// Adds to bounds in every configuration of points of these masses [kg], those that are pinned being none. Once masses, stiffness or pins
  /// have changed, before add_bounds.
  virtual void add_any_bounds(const Scalars& mass, const std::vector<bool>& pinned, AnyBounds& bounds) const = 0;
  /// sums += blocks S_p that bound K at x (body/stability.hpp) [N/m], as xx yy zz xy xz yz, each (points). Returns whether they may go
  /// beyond the bounds in every configuration.
  virtual bool add_bounds(const Points& x, const Scalars& mass, const std::vector<bool>& pinned, Scalars& sums) const = 0;
  /// Whether points have moved so far since x0 that bounds at x0 are too old for x.
  virtual bool has_deformed(const Points& x, const Points& x0) const = 0;
  /// How far it moves points that are at x and move with v [m]; infinite unless all is finite.
  virtual double swing(const Points& x, const Points& v, const Swing& by) const = 0;
  /// Number of cells that are turned inside out by what the energy knows of them beside their corners.
  virtual int folded_cells(const Points&) const { return 0; }
  /// Whether the forces on points that lie and move alike have no direction.
  virtual bool undecided(const Points&, const Points&, const std::vector<bool>&) const { return false; }

  /// Whether it has dashpots; the smallest and the largest ratio of a dashpot to its stiffness [s].
  bool dashpots() const { return longest_time() > 0; }
  virtual double shortest_time() const { return 0; }
  virtual double longest_time() const { return 0; }
  /// f -= C(x) v: what the dashpots exert on points at x that move with v, all (points, 3). A motion as a rigid body is not braked. With a
  /// drift [s] they go by the mean rate of their lengths while all points go straight on for that time, or have come straight for it
  /// (negative).
  virtual void add_dashpot_force(const Points&, const Points&, Points&, double = 0) const {}
  /// What the dashpots take of points at x that move with v [W].
  virtual double dashpot_power(const Points&, const Points&) const { return 0; }
  /// Bound of the rate at which the dashpots change velocities at x [1/s]. 0 where longest_time() times the largest squared frequency in
  /// any configuration is one.
  virtual double dashpot_rate(const Points&, const Scalars&, const std::vector<bool>&) const { return 0; }

  /// A pass that also moves the points, if there is one; it knows no dashpots.
  virtual const FusedPass* fused() const { return nullptr; }
};

}  // namespace softffd
