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
/// same for every point of every lattice: by direction, first end before second end.
///
/// While the forces on a block are in registers its points may be kicked and drift: where nothing stands between the forces of a step and
/// the next drift, a step reads and writes each position and velocity once.
#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "forces/kernels.hpp"
#include "model/lattice.hpp"

namespace softffd {

/// Kicks by the forces at x, one after the other, then a drift: v <- a v + b (f + outside) for each kick; x <- x + h v.
struct Stage {
  struct Kick {
    const double *a, *b;  ///< (points)
  };
  std::array<Kick, 2> kicks;
  int count;  ///< of kicks
  double h;   ///< [s]
};

struct SpringPass {
  static constexpr int lanes = 8;
  using Offsets = std::array<std::ptrdiff_t, directions.size()>;

  /// Without springs yet.
  explicit SpringPass(const Lattice& lattice);

  /// The springs of one of the lattice's directions.
  void set(std::size_t direction, const kernels::SpringRow& row);

  /// f = forces at x [N], eq. (6): k (1 - l/r) d on the first point, the opposite on the second; r = 0 gives no force. Both (3 * points),
  /// coordinate by coordinate.
  void force(const double* x, double* f) const;

  /// The stage from positions x and velocities v; next: the positions after it. All (3 * points); outside forces [N].
  void advance(const Stage& stage, const double* outside, const double* x, double* v, double* next) const;

  struct alignas(64) Block {
    double of[lanes] = {};
  };
  struct alignas(64) Material {
    double stiffness[lanes] = {}, rest_length[lanes] = {};
  };

  int points;                        ///< >= 8
  bool wraps;                        ///< a ring is shorter than the lattice
  int tail;                          ///< first point of the first block with neighbours' lanes behind the last point
  std::ptrdiff_t before;             ///< [numbers] from a ring's beginning to its first block: the way to the farthest neighbour, at least
  std::ptrdiff_t ring, column;       ///< [numbers]: a ring's length; from one coordinate of the tail's copy to the next
  Offsets offsets;                   ///< from a point to its neighbour in each direction, >= 1
  std::vector<Material> material;    ///< block by block, direction by direction
  std::vector<unsigned> first;       ///< (blocks) bits of the directions of which any spring begins at the block's points
  std::vector<unsigned> second;      ///< (blocks) of which any spring ends there
  mutable std::vector<Block> rings;  ///< by direction and coordinate
  mutable std::vector<Block> end;    ///< the tail of x by coordinate, with room around it
};

}  // namespace softffd
