#include "bernstein.hpp"

namespace softffd {

Scalars bernstein(double t, int n) {
  Scalars weights = Scalars::Zero(n);
  weights[0] = 1;
  for (int degree = 1; degree < n; ++degree) {
    for (int i = degree; i > 0; --i) weights[i] = (1 - t) * weights[i] + t * weights[i - 1];
    weights[0] *= 1 - t;
  }
  return weights;
}

Scalars embedding_weights(const Lattice& lattice, const Vec3& at) {
  std::array<Scalars, 3> axis;
  for (int a = 0; a < 3; ++a) axis[a] = bernstein((at[a] - lattice.origin[a]) / lattice.size[a], lattice.counts[a]);
  Scalars weights(lattice.points());
  for (int k = 0; k < lattice.counts[2]; ++k)
    for (int j = 0; j < lattice.counts[1]; ++j)
      for (int i = 0; i < lattice.counts[0]; ++i) weights[lattice.index(i, j, k)] = axis[0][i] * axis[1][j] * axis[2][k];
  return weights;
}

}  // namespace softffd
