#include "lattice.hpp"

#include <Eigen/Geometry>

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

namespace {

bool folded(const Lattice& lattice, const Points& x, int i, int j, int k) {
  for (int corner = 0; corner < 8; ++corner) {
    const int a = corner & 1, b = corner >> 1 & 1, c = corner >> 2;
    const Vec3 here = row(x, lattice.index(i + a, j + b, k + c));
    const Vec3 e1 = row(x, lattice.index(i + 1 - a, j + b, k + c)) - here;
    const Vec3 e2 = row(x, lattice.index(i + a, j + 1 - b, k + c)) - here;
    const Vec3 e3 = row(x, lattice.index(i + a, j + b, k + 1 - c)) - here;
    const double orientation = (a + b + c) % 2 == 0 ? 1.0 : -1.0;
    if (!(orientation * e1.dot(e2.cross(e3)) > 0)) return true;
  }
  return false;
}

}  // namespace

int folded_cells(const Lattice& lattice, const Points& x) {
  int count = 0;
  for (int k = 0; k + 1 < lattice.counts[2]; ++k)
    for (int j = 0; j + 1 < lattice.counts[1]; ++j)
      for (int i = 0; i + 1 < lattice.counts[0]; ++i) count += folded(lattice, x, i, j, k);
  return count;
}

}  // namespace softffd
