#include "forces/regions.hpp"

namespace softffd {

namespace {

std::vector<bool> mask(const std::vector<int>& points, int count) {
  std::vector<bool> selected(count, false);
  for (int p : points) selected[p] = true;
  return selected;
}

/// Returns the cells whose eight corners are all selected.
std::vector<int> whole_cells(const Lattice& lattice, const std::vector<bool>& selected) {
  std::vector<int> found;
  int cell = 0;
  for (int k = 0; k + 1 < lattice.counts[2]; ++k)
    for (int j = 0; j + 1 < lattice.counts[1]; ++j)
      for (int i = 0; i + 1 < lattice.counts[0]; ++i, ++cell) {
        bool whole = true;
        for (int c = 0; c < 8; ++c) whole = whole && selected[lattice.index(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2))];
        if (whole) found.push_back(cell);
      }
  return found;
}

}  // namespace

Regions::Regions(const Lattice& lattice, const std::vector<Region>& regions)
    : modulus_of_cells_(lattice.cells()), time_of_cells_(lattice.cells()) {
  for (const Region& region : regions) {
    const std::vector<bool> selected = mask(region.points, lattice.points());
    if (region.stiffness) stiffness_.push_back({selected, *region.stiffness});
    if (region.modulus) modulus_.push_back({whole_cells(lattice, selected), *region.modulus});
    if (region.internal_damping) {
      dashpots_.push_back({selected, *region.internal_damping});
      time_.push_back({whole_cells(lattice, selected), *region.internal_damping});
    }
  }
}

void Regions::set_stiffness(const Stiffness& stiffness, double time, Springs& springs) const {
  springs.set_stiffness(stiffness, stiffness_);
  springs.set_dashpots(time, dashpots_);
}

void Regions::set_modulus(double modulus, double time, Springs& springs) {
  fill(modulus, modulus_, modulus_of_cells_);
  fill(time, time_, time_of_cells_);
  springs.set_modulus(modulus_of_cells_, time_of_cells_);
}

void Regions::fill(double of_all, const std::vector<Cells>& overrides, Scalars& values) {
  values.setConstant(of_all);
  for (const Cells& cells : overrides)
    for (const int cell : cells.numbers) values[cell] = cells.value;
}

}  // namespace softffd
