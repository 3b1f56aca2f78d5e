/// Vectors from each point of a lattice to its next neighbour along the axes. Their change shows that a body has deformed.
#pragma once
#include <array>

#include "model/lattice.hpp"

namespace softffd {

class LatticeEdges {
 public:
  explicit LatticeEdges(const Lattice& lattice);

  /// True if an edge differs between x and x0 by more than `part` of the shortest length at rest along its axis [1], or is not a number.
  bool changed(const Points& x, const Points& x0, double part) const;
  /// Calls visit(p, q) for every pair of neighbours.
  template <class Visit>
  void visit(const Visit& visit) const {
    for (const Axis& axis : axes_)
      for (int p = 0; p < axis.exist.size(); ++p)
        if (axis.exist[p] > 0) visit(p, p + axis.offset);
  }

 private:
  struct Axis {
    int offset;
    double length;  ///< shortest edge at rest [m]
    Scalars exist;  ///< (lanes) 1 if there is an edge from point p to p + offset in lane p, else 0
  };
  std::array<Axis, 3> axes_;
};

}  // namespace softffd
