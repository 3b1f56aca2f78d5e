/// Symmetric matrices of the lattice by what is not zero in them: a 3 x 3 block for every point and for every pair of points within a cell.
///
/// The 13 directions to neighbours of higher index are rows of lanes, as the springs' are: lane p of a direction holds the block between
/// point p and point p + offset, so that a product runs along memory. Takes 984 bytes a point, 4 MB for 16 x 16 x 16. Where a lattice is
/// so narrow that directions have one offset, the first of them has what is between such points.
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
  /// Of two points; or of one, then symmetric.
  void set_block(int p, int q, const Mat3& block);
  void add_block(int p, int q, const Mat3& block);

  /// y = A x.
  void multiply(const Points& x, Points& y) const;
  /// Blocks of the diagonal as xx yy zz xy xz yz, each (points).
  const Scalars& diagonal() const { return diagonal_; }

  /// Calls visit(p, q, block) for every pair p < q that has one.
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
