/// A lattice whose points stand in disorder, a fifth of a metre from their places.
#pragma once
#include <cmath>

#include "model/lattice.hpp"

namespace softffd {

inline Points crumpled(const Lattice& lattice) {
  Points x = rest_positions(lattice);
  for (int p = 0; p < x.rows(); ++p)
    for (int a = 0; a < 3; ++a) x(p, a) += 0.2 * std::sin(7.0 * p + 3.0 * a);
  return x;
}

}  // namespace softffd
