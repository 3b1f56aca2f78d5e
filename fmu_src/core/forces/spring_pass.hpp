/// The forces of all springs in one pass over the points, eight at a time, and what moves the points by them.
///
/// What limits a step is the square root and the division of each spring; all else has to be done in their shade. So the eight points of a
/// block stay in registers while their neighbours in the 13 directions pass by. What a spring gives its first point is written once, to
/// its direction's ring, and read twice: in place for that point, and shifted, with the other sign, for the second:
///
///      block a:   d = x[a + offset] - x[a],  s = k (1 - l/r) d          ring[a] = s
///      then:      the block before a sums up, direction by direction    f[b] += ring[b],  f[b] -= ring[b - offset]
///
///      ring of offset 5:    s s s s s s s s|s s s s s s s s|s s s s s s s s|. . . . . . . .
///                                           b: the block before             '|': blocks; '.': written after this
///                                 [- - - - - - - -]   what it loses
///
/// It sums up one block late, because what has just been written is slow to read in another alignment. A ring holds a small lattice whole,
/// and what no spring is given to stays 0 there. Else it wraps: it is little longer than the way to the farthest neighbour and so stays in
/// the near caches at any size; a copy of its first block stands behind its end, so that no reading is cut in two. The order of sums is the
/// same for every point of every lattice: by direction, first end before second end. A register all of whose lanes hold no spring of a
/// direction is passed over: of eight lanes seldom, of four one in five, which takes a tenth of a step's time.
///
/// Several threads take a part of the blocks each, with rings of their own: what springs of the blocks before a part give into it is worked
/// out once more. So no thread waits for another within a pass, and each point's sum is the one it always is, to the last bit.
///
/// While the forces on a block are in registers its points may be kicked and drift: where nothing stands between the forces of a step and
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

  /// How many of so many threads a lattice has enough points for.
  static int threads_of_use(const Lattice& lattice, int threads);

  /// Without springs yet. Each member of the team takes a part; null: one thread, as it is.
  SpringPass(const Lattice& lattice, std::shared_ptr<Team> team);

  /// The springs, direction by direction.
  void set(const Rows& rows);
  /// Dashpots along them, of c (lanes) in each direction [N s/m].
  void set_dashpots(const Rows& rows, const std::array<const double*, directions.size()>& c);

  /// f = forces at x [N], eq. (6): k (1 - l/r) d on the first point, the opposite on the second; r = 0 gives no force. Both (3 * points),
  /// coordinate by coordinate.
  void force(const double* x, double* f) const;

  /// f -= what the dashpots, if there are any, take from points at x that move with v: c r u on a spring's first point along the unit
  /// vector u, the opposite on the second, r the mean rate of its length if its ends go straight on for the time `drift` from now, or have
  /// come straight for it where that is negative. With w the velocity of the second end past the first, r = u.w + drift (w across u)^2 / 2
  /// per length.
  void add_dashpot_force(const double* x, const double* v, double drift, double* f) const;

  /// The stage from positions x and velocities `before`, to positions `next` and velocities v; outside forces [N]; all (3 * points).
  /// `before` and v may be the same; of blocks that are kept those after the first kick go to `before`.
  void advance(const Stage& stage, const double* outside, const double* x, double* before, double* v, double* next,
               const Between& between) const;

  struct alignas(64) Block {
    double of[lanes] = {};
  };
  /// What one thread does: sums up the blocks from `begin` to before `end`, after the springs of those from `lead` on.
  struct Part {
    int lead, begin, end;
    std::vector<Block> rings;                    ///< by direction and coordinate
    std::array<std::vector<Block>, 2> behind{};  ///< the tails of x and v by coordinate, with room around them
  };

  int points;                   ///< >= 8
  bool wraps;                   ///< a ring is shorter than the lattice
  int tail;                     ///< first point of the first block with neighbours' lanes behind the last point
  std::ptrdiff_t before;        ///< [numbers] from a ring's beginning to its first block: the way to the farthest neighbour, at least
  std::ptrdiff_t ring, column;  ///< [numbers]: a ring's length; from one coordinate of the tail's copy to the next
  Offsets offsets;              ///< from a point to its neighbour in each direction, >= 1
  SpringKinds kinds;            ///< of the blocks
  std::optional<SpringKinds> dashpots;  ///< their c for a stiffness
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
