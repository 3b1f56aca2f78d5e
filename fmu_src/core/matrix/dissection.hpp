/// In which order a lattice's points leave its equations: nested dissection (George 1973).
///
/// A plane of points across the longest axis cuts a box of points into two that do not meet; each is cut again, until what is left is
/// small. First the smallest boxes leave, then the planes between them, last of all the plane in the middle. What leaves together is a
/// front: its own points, and as its boundary those that they then still meet, all of which leave later. A solid's nodes meet within their
/// patches: they are cut along the faces of patches, and the inside of each patch is a front.
///
///      y   . . . | . . .        own points: the six boxes first, each with boundary on the planes around it,
///          . . . | . . .        then the two planes -, with boundary on |, then |, which has none
///          - - - | - - -
///          . . . | . . .
///
/// The points of a front have rows: its own first, then its boundary, all in the order in which they leave.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "model/lattice.hpp"

namespace softffd {

class Dissection {
 public:
  /// Rows of a boundary that are rows next to each other in the parent, too.
  struct Run {
    int from, to, count;
  };
  struct Front {
    int own = 0;                            ///< rows that leave
    int parent = -1;                        ///< the front that its boundary's first point leaves with; -1: it has no boundary
    bool first_child = false;               ///< of its parent, in the order of fronts
    std::vector<int> points = {};           ///< of all rows
    std::vector<Run> in_parent = {};        ///< its boundary
    std::array<int, 3> corner{}, extent{};  ///< of a box around all rows, in points
    std::vector<std::int16_t> rows = {};    ///< of the points in that box

    int boundary() const { return int(points.size()) - own; }
  };

  explicit Dissection(const Lattice& lattice);

  /// Children come before their parents.
  const std::vector<Front>& fronts() const { return fronts_; }
  /// The front that a point leaves with, and its row there.
  int front(int p) const { return place_[p].front; }
  int row(int p) const { return place_[p].row; }
  /// Row of a point on the boundary of a front.
  int row(const Front& front, int p) const { return front.rows[in_box(front, p)]; }

  /// Multiplications of a Cholesky factor of three unknowns a point, and of a solution with it.
  double factor_work() const;
  double solution_work() const;

 private:
  struct Box {
    std::array<int, 3> first, last;  ///< points, both among them
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
