/// Ways from each point of a lattice to its next neighbour along the axes, by which it is seen that a body has deformed.
#pragma once
#include <array>

#include "model/lattice.hpp"

namespace softffd {

class LatticeEdges {
 public:
  explicit LatticeEdges(const Lattice& lattice);

  /// Whether any of them differs between two states by more than this part of the shortest along its axis at rest [1], or is no number.
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
    double length;  ///< at rest, the shortest [m]
    Scalars exist;  ///< (lanes) 1 or 0, lane p from point p to p + offset
  };
  std::array<Axis, 3> axes_;
};

}  // namespace softffd
