/// Computes the forces of all springs in one pass over the points, eight at a time, and moves the points by these forces if asked to.
///
/// The square root and the division of each spring limit the speed of a step, and all other work must overlap with them. Therefore the
/// eight points of a block stay in registers while their neighbours in the 13 directions are read. The force of a spring on its first
/// point is written once, to the ring buffer of its direction, and read twice: in place for that point, and shifted, with the opposite
/// sign, for the second:
///
///      block a:   d = x[a + offset] - x[a],  s = k (1 - l/r) d          ring[a] = s
///      then:      the block before a sums up, direction by direction    f[b] += ring[b],  f[b] -= ring[b - offset]
///
///      ring of offset 5:    s s s s s s s s|s s s s s s s s|s s s s s s s s|. . . . . . . .
///                                           b: the block before             '|': blocks; '.': written after this
///                                 [- - - - - - - -]   what it loses
///
/// A block is summed up one block late, because data just written is slow to read in another alignment. A ring holds a small lattice
/// whole; entries to which no spring contributes stay 0. For a larger lattice the ring wraps: it is little longer than the distance to
/// the farthest neighbour and so stays in the near caches at any size. A copy of its first block stands behind its end, so that no read
/// is split in two. The order of summation is the same for every point of every lattice: by direction, first end before second end. A
/// register none of whose lanes holds a spring of a direction is skipped: seldom with eight lanes, one in five with four, which saves a
/// tenth of a step's time.
///
/// Each of several threads takes a part of the blocks, with rings of its own. The forces that springs of the blocks before a part exert
/// on it are computed once more. So no thread waits for another within a pass, and each point's sum is always the same, to the last bit.
///
/// While the forces on a block are in registers, its points may be kicked and drift. If nothing comes between the forces of a step and
/// the next drift, a step reads and writes each position and velocity once.
#pragma once
#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "forces/fused_pass.hpp"
#include "forces/kernels.hpp"
#include "forces/spring_ends.hpp"
#include "forces/spring_kinds.hpp"
#include "machine/team.hpp"
#include "model/lattice.hpp"

namespace softffd {

struct SpringPass {
  static constexpr int lanes = FusedPass::lanes;
  static_assert(lanes == SpringKinds::lanes);
  using Between = FusedPass::Between;
  using Offsets = std::array<std::ptrdiff_t, directions.size()>;
  using Rows = std::array<kernels::SpringRow, directions.size()>;

  /// Returns for how many of these threads the lattice has enough points.
  static int threads_of_use(const Lattice& lattice, int threads);

  /// Creates a pass without springs. Each member of the team takes a part; null: the calling thread does all.
  SpringPass(const Lattice& lattice, std::shared_ptr<Team> team);

  /// Sets the springs, direction by direction.
  void set(const Rows& rows);
  /// Sets dashpots along the springs, of coefficients c (lanes) in each direction [N s/m].
  void set_dashpots(const Rows& rows, const std::array<const double*, directions.size()>& c);

  /// f = forces at x [N], eq. (6): k (1 - l/r) d on the first point, the opposite on the second; r = 0 gives no force. Both (3 * points),
  /// coordinate by coordinate.
  void force(const double* x, double* f) const;

  /// Adds the dashpot forces, if there are dashpots, to f, for points at x with velocities v: c r u on a spring's first point along the
  /// unit vector u, the opposite on the second. Here r is the mean rate of the spring's length while its ends move on in straight lines
  /// for the time `drift` from now, or, if that is negative, have moved so until now. With w the velocity of the second end relative to
  /// the first, r = u.w + drift (w across u)^2 / 2 per length.
  void add_dashpot_force(const double* x, const double* v, double drift, double* f) const;

  /// Carries out the stage from positions x and velocities `before` to positions `next` and velocities v; outside forces [N]; all arrays
  /// are (3 * points). `before` and v may be the same. For kept blocks the velocities after the first kick are written to `before`.
  void advance(const Stage& stage, const double* outside, const double* x, double* before, double* v, double* next,
               const Between& between) const;

  struct alignas(64) Block {
    double of[lanes] = {};
  };
  /// The part of one thread, which computes the springs of the blocks from `lead` on and sums up the blocks from `begin` to before `end`.
  struct Part {
    int lead, begin, end;
    std::vector<Block> rings;                    ///< by direction and coordinate
    std::array<std::vector<Block>, 2> behind{};  ///< copies of the tails of x and v by coordinate, with room around them
  };

  int points;                   ///< >= 8
  bool wraps;                   ///< a ring is shorter than the lattice
  int tail;                     ///< first point of the first block some of whose neighbours' lanes are behind the last point
  std::ptrdiff_t before;        ///< [numbers] from a ring's beginning to its first block: at least the distance to the farthest neighbour
  std::ptrdiff_t ring, column;  ///< [numbers]: a ring's length; from one coordinate of the tail's copy to the next
  Offsets offsets;              ///< from a point to its neighbour in each direction, >= 1
  SpringKinds kinds;            ///< springs of the blocks
  std::optional<SpringKinds> dashpots;  ///< with c in place of the stiffness
  SpringEnds first, second;             ///< where springs begin, and where they end
  mutable std::vector<Part> parts;      ///< one for each thread
  std::shared_ptr<Team> team;

 private:
  void divide(int blocks);
  std::vector<Block> room() const { return std::vector<Block>(3 * column / lanes + 1); }
  template <class Set>
  void fill(SpringKinds& of, const Set& set) const;
  template <class Act>
  void each_part(const Act& act) const;
};

}  // namespace softffd
