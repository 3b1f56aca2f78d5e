#include "model/basis.hpp"

#include "model/basis_formulas.hpp"
#include "model/lobatto.hpp"

namespace softffd {

Scalars weights(Basis basis, double t, int n) {
  if (basis == Basis::patches) return lobatto::interpolation(t, n);
  Scalars weights = Scalars::Zero(n);
  if (basis == Basis::bezier || n <= 4) {
    formulas::bernstein<1>(&t, n, reinterpret_cast<double (*)[1]>(weights.data()));
    return weights;
  }
  const formulas::Span span = formulas::bsplines(formulas::parameter(t, n), n);
  for (int r = 0; r < 4; ++r) weights[int(span.first) + r] = span.values[r];
  return weights;
}

Embedding embed(Basis basis, const Lattice& lattice, const Vec3& at) {
  std::array<Scalars, 3> axis;
  for (int a = 0; a < 3; ++a) axis[a] = weights(basis, (at[a] - lattice.origin[a]) / lattice.size[a], lattice.counts[a]);
  Embedding embedding;
  for (int k = 0; k < lattice.counts[2]; ++k)
    for (int j = 0; j < lattice.counts[1]; ++j)
      for (int i = 0; i < lattice.counts[0]; ++i) {
        const double weight = axis[0][i] * axis[1][j] * axis[2][k];
        if (weight == 0) continue;
        embedding.points.push_back(lattice.index(i, j, k));
        embedding.weights.push_back(weight);
      }
  return embedding;
}

}  // namespace softffd
