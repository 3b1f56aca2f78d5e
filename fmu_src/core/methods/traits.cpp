#include "methods/traits.hpp"

#include <algorithm>

namespace softffd {

ImplicitWork::ImplicitWork(const Lattice& lattice) {
  const double layers = *std::max_element(lattice.counts.begin(), lattice.counts.end()), per_layer = lattice.points() / layers / 16;
  factor = 30 * per_layer * per_layer;
  step = 8 + 15 * per_layer;
}

}  // namespace softffd
