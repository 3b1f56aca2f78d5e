/// The order in which the points of a lattice are eliminated from its equations: nested dissection (George 1973).
///
/// A plane of points across the longest axis cuts a box of points into two boxes that are not coupled. Each is cut again until the boxes
/// are small. The smallest boxes are eliminated first, then the planes between them, the plane in the middle last. Points that are
/// eliminated together form a front. The boundary of a front consists of the points that are still coupled with it then, all of them
/// eliminated later. Nodes of a solid are coupled within patches: it is cut along faces of patches, and the inside of each patch is a
/// front.
///
///      y   . . . | . . .        own points: the six boxes first, each with boundary on the planes around it,
///          . . . | . . .        then the two planes -, with boundary on |, then |, which has none
///          - - - | - - -
///          . . . | . . .
///
/// The rows of a front are its points: first its own points, then its boundary, all in the order of elimination.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "model/lattice.hpp"

namespace softffd {

class Dissection {
 public:
  /// Consecutive boundary rows of a front that are consecutive rows of the parent, too.
  struct Run {
    int from, to, count;
  };
  struct Front {
    int own = 0;                            ///< number of rows that are eliminated
    int parent = -1;                        ///< the front that eliminates the first boundary point; -1: no boundary
    bool first_child = false;               ///< first child of its parent, in the order of fronts
    std::vector<int> points = {};           ///< points of all rows
    std::vector<Run> in_parent = {};        ///< where its boundary rows are in the parent
    std::array<int, 3> corner{}, extent{};  ///< box around the points of all rows, in points
    std::vector<std::int16_t> rows = {};    ///< rows of the points in that box

    int boundary() const { return int(points.size()) - own; }
  };

  explicit Dissection(const Lattice& lattice);

  /// Children come before their parents.
  const std::vector<Front>& fronts() const { return fronts_; }
  /// The front that eliminates a point, and the row of the point there.
  int front(int p) const { return place_[p].front; }
  int row(int p) const { return place_[p].row; }
  /// Row of a point in a front that contains the point.
  int row(const Front& front, int p) const { return front.rows[in_box(front, p)]; }

  /// Number of multiplications of a Cholesky factor with three unknowns per point, and of a solution with the factor.
  double factor_work() const;
  double solution_work() const;

 private:
  struct Box {
    std::array<int, 3> first, last;  ///< points, both included
    int extent(int axis) const { return last[axis] - first[axis] + 1; }
    int points() const { return extent(0) * extent(1) * extent(2); }
  };
  struct Place {
    std::array<int, 3> at;
    int front, row;
  };
  bool find_cut(const Box& box, int& axis, int& plane) const;
  void dissect(const Box& box);
  void add_front(const Box& own, const Box& around);
  void order_boundaries();
  int in_box(const Front& front, int p) const {
    const auto& at = place_[p].at;
    return at[0] - front.corner[0] + front.extent[0] * (at[1] - front.corner[1] + front.extent[1] * (at[2] - front.corner[2]));
  }

  Lattice lattice_;
  std::vector<Front> fronts_;
  std::vector<Place> place_;  ///< (points)
};

}  // namespace softffd
