#include "model/lattice.hpp"

#include <algorithm>

#include "model/lobatto.hpp"

namespace softffd {

namespace {

struct Range {
  int begin, end;
};

/// Returns the points of an axis of n points that share an element with point i.
Range coupled(int i, int n, bool lobatto) {
  if (!lobatto) return {std::max(i - 1, 0), std::min(i + 2, n)};
  const int patch = i / 3 * 3;  // the patch that begins at i, or has i inside
  return {i == patch ? std::max(i - 3, 0) : patch, std::min(patch + 4, n)};
}

}  // namespace

std::vector<std::vector<int>> coupled_points(const Lattice& lattice) {
  const auto& n = lattice.counts;
  std::vector<std::vector<int>> found(lattice.points());
  for (int p = 0; p < lattice.points(); ++p) {
    const Range x = coupled(p % n[0], n[0], lattice.lobatto), y = coupled(p / n[0] % n[1], n[1], lattice.lobatto),
                z = coupled(p / n[0] / n[1], n[2], lattice.lobatto);
    for (int k = z.begin; k < z.end; ++k)
      for (int j = y.begin; j < y.end; ++j)
        for (int i = x.begin; i < x.end; ++i)
          if (const int q = lattice.index(i, j, k); q != p) found[p].push_back(q);
  }
  return found;
}

Points rest_positions(const Lattice& lattice) {
  Points rest(lattice.points(), 3);
  const auto& n = lattice.counts;
  const auto place = [&](int i, int axis) { return lattice.lobatto ? lobatto::place(i, n[axis]) : double(i) / (n[axis] - 1); };
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i) {
        const Vec3 fraction(place(i, 0), place(j, 1), place(k, 2));
        set_row(rest, lattice.index(i, j, k), lattice.origin + lattice.size.cwiseProduct(fraction));
      }
  return rest;
}

}  // namespace softffd
