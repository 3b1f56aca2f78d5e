/// The cells of the lattice and the volumes at their corners.
///
/// At every corner (a, b, c) of a cell, a, b, c = 0 or 1, three of the cell's twelve edges meet, one along each axis of the lattice. With
/// every edge taken in the direction of rising index and divided by its length at rest, the relative volume of the corner is
///
///      J = det(X_bc, Y_ac, Z_ab),       1 at rest, 0 where the three edges lie in a plane, negative where the corner is inverted,
///
/// where X_bc is the edge along x at (., b, c). The formula needs no signs: from corner 0 to corner 1 of an axis both the direction of
/// the edge and the handedness of the corner change. Cells stand in lanes, as springs do: lane p is the cell whose corner (0, 0, 0) is
/// point p, and each edge is made once for the up to four cells around it. Lanes at the upper ends of the rows of points have no cell:
///
///      p        0  1  2  3 | 4  5  6  7 ...
///      cell     *  *  *  . | *  *  *  .
#pragma once
#include <array>

#include "model/lattice.hpp"

namespace softffd {

class Cells {
 public:
  explicit Cells(const Lattice& lattice);

  /// Returns the smallest corner volume J of each lane at x, (points, 3): (lanes), infinite without a cell, valid until the next call.
  const Scalars& smallest(const Points& x) const;
  /// True if any corner has J < limit at x.
  bool any_below(double limit, const Points& x) const;
  /// Returns the number of cells with a corner of J <= 0, inverted or flat.
  int folded(const Points& x) const;

  int lanes() const { return int(absent_.size()); }

  struct Corner {
    double volume;                 ///< J
    std::array<int, 4> points;     ///< the corner and its neighbours along x, y, z
    std::array<Vec3, 4> gradient;  ///< of J with respect to these four points [1/m]
  };
  Corner corner(const Points& x, int lane, int a, int b, int c) const;

  /// Calls visit(corner) for every corner with J < limit. Returns whether there was any.
  template <class Visit>
  bool visit_below(double limit, const Points& x, Visit visit) const {
    if (!any_below(limit, x)) return false;
    for (int lane = 0; lane < lanes(); ++lane) {
      if (!(smallest_[lane] < limit)) continue;
      for (int number = 0; number < 8; ++number) {
        const Corner here = corner(x, lane, number & 1, number >> 1 & 1, number >> 2);
        if (here.volume < limit) visit(here);
      }
    }
    return true;
  }
  /// f += factor times the sum over all corners with J < limit of (limit - J)^2 dJ/dx.
  void add_squares(double limit, double factor, const Points& x, Points& f) const;

 private:
  std::array<int, 3> offset_;         ///< index offset from a point to its neighbour along each axis
  std::array<double, 3> per_length_;  ///< 1 / length of the edges at rest [1/m]
  int points_;
  Scalars absent_;                 ///< (lanes) 0 where there is a cell, infinite where there is none
  mutable Scalars edges_, pulls_;  ///< (9 * points) by axis of the edge, then by coordinate; empty until a corner resists
  mutable Scalars smallest_;       ///< (lanes)
};

}  // namespace softffd
