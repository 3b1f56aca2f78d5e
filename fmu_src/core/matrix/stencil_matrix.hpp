/// Sparse symmetric matrices of the lattice: a 3 x 3 block for every point and for every pair of points within a cell.
///
/// Each of the 13 directions to neighbours of higher index is a row of lanes, as for the springs: lane p of a direction holds the block
/// between point p and point p + offset, so that a product runs along memory. A matrix takes 984 bytes per point, 4 MB for 16 x 16 x 16.
/// If a lattice is so narrow that several directions have the same offset, the first of them holds the blocks of such pairs.
#pragma once
#include <array>
#include <vector>

#include "forces/blocks.hpp"
#include "model/lattice.hpp"

namespace softffd {

class StencilMatrix {
 public:
  explicit StencilMatrix(const Lattice& lattice);

  void clear();
  Mat3 block(int p, int q) const;
  /// Sets the block of two points within a cell, or the symmetric block of one point.
  void set_block(int p, int q, const Mat3& block);
  void add_block(int p, int q, const Mat3& block);

  /// y = A x.
  void multiply(const Points& x, Points& y) const;
  /// Blocks of the diagonal as xx yy zz xy xz yz, each (points).
  const Scalars& diagonal() const { return diagonal_; }

  /// Calls visit(p, q, block) for every pair p < q with a block that is not zero.
  template <class Visit>
  void visit_couplings(Visit visit) const {
    for (std::size_t d = 0; d < offsets_.size(); ++d)
      for (int p = 0; p + offsets_[d] < points_; ++p)
        if (const Mat3 block = coupling(int(d), p); !block.isZero(0)) visit(p, p + offsets_[d], block);
  }

 private:
  int direction(int offset) const;
  int lanes(int direction) const { return points_ - offsets_[direction]; }
  Mat3 coupling(int direction, int p) const;
  template <class Change>
  void change(int p, int q, const Mat3& block, Change change);

  int points_;
  std::array<int, directions.size()> offsets_;
  std::array<Scalars, directions.size()> couplings_;  ///< (9 * lanes), entry by entry
  Scalars diagonal_;                                  ///< (6 * points)
};

}  // namespace softffd
