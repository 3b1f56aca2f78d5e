/// The forces of all springs in one pass over the points, eight at a time.
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
/// It sums up one block late, because what has just been written is slow to read in another alignment. A ring is little longer than the
/// way to the farthest neighbour and so stays in the near caches at any size of the lattice; a copy of its first block stands behind its
/// end, so that no reading is cut in two. The order of sums is the same for every point of every lattice: by direction, first end before
/// second end.
#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "forces/kernels.hpp"
#include "model/lattice.hpp"

namespace softffd {

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

  struct alignas(64) Block {
    double of[lanes] = {};
  };
  struct alignas(64) Material {
    double stiffness[lanes] = {}, rest_length[lanes] = {};
  };

  int points;                        ///< >= 8
  int tail;                          ///< first point of the first block with neighbours' lanes behind the last point
  std::ptrdiff_t ring, column;       ///< [numbers]: a ring's length; from one coordinate of the tail's copy to the next
  Offsets offsets;                   ///< from a point to its neighbour in each direction, >= 1
  std::vector<Material> material;    ///< block by block, direction by direction
  std::vector<unsigned> springs;     ///< (blocks) bits of the directions that have any
  mutable std::vector<Block> rings;  ///< by direction and coordinate, ring + lanes numbers each
  mutable std::vector<Block> end;    ///< the tail of x by coordinate, with room behind it that is 0
};

}  // namespace softffd
