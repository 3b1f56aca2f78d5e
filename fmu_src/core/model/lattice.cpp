#include "model/lattice.hpp"

#include "model/lobatto.hpp"

namespace softffd {

Points rest_positions(const Lattice& lattice) {
  Points rest(lattice.points(), 3);
  const auto& n = lattice.counts;
  const auto place = [&](int i, int axis) { return lattice.lobatto ? lobatto::place(i, n[axis]) : double(i) / (n[axis] - 1); };
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i) {
        const Vec3 share(place(i, 0), place(j, 1), place(k, 2));
        set_row(rest, lattice.index(i, j, k), lattice.origin + lattice.size.cwiseProduct(share));
      }
  return rest;
}

}  // namespace softffd
