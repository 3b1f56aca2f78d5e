#include "model/lattice.hpp"

namespace softffd {

Points rest_positions(const Lattice& lattice) {
  Points rest(lattice.points(), 3);
  const auto& n = lattice.counts;
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i) {
        const Vec3 share(double(i) / (n[0] - 1), double(j) / (n[1] - 1), double(k) / (n[2] - 1));
        set_row(rest, lattice.index(i, j, k), lattice.origin + lattice.size.cwiseProduct(share));
      }
  return rest;
}

}  // namespace softffd
