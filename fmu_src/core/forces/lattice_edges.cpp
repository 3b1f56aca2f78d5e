#include "forces/lattice_edges.hpp"

#include "forces/kernels.hpp"
#include "model/lobatto.hpp"

namespace softffd {

LatticeEdges::LatticeEdges(const Lattice& lattice) {
  const auto& n = lattice.counts;
  for (int a = 0; a < 3; ++a) {
    Axis& axis = axes_[a];
    axis.offset = directions[a].offset(lattice);
    axis.length = lattice.lobatto ? lattice.size[a] * lobatto::place(1, n[a]) : lattice.cell()[a];
    axis.exist = Scalars::Zero(lattice.points() - axis.offset);
    for (int k = 0; k < n[2]; ++k)
      for (int j = 0; j < n[1]; ++j)
        for (int i = 0; i < n[0]; ++i)
          if (directions[a].within(lattice, i, j, k)) axis.exist[lattice.index(i, j, k)] = 1;
  }
}

bool LatticeEdges::changed(const Points& x, const Points& x0, double part) const {
  for (const Axis& axis : axes_) {
    const kernels::SpringRow edges{0, int(axis.exist.size()), axis.offset, axis.exist.data(), nullptr};
    const double limit = part * axis.length;
    if (!(kernels::largest_change(edges, int(x.rows()), x.data(), x0.data()) <= limit * limit)) return true;
  }
  return false;
}

}  // namespace softffd
