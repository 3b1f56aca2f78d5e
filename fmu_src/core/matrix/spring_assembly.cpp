#include "matrix/spring_assembly.hpp"

namespace softffd {

void set_diagonal_blocks(const Body& body, const Scalars& sums, const Scalars& diagonal, LayerMatrix& matrix) {
  const int n = body.points();
  for (int p = 0; p < n; ++p)
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b <= a; ++b)
        matrix.at(p, a, p, b) = body.pinned[p] ? a == b : sums[component[a][b] * n + p] + (a == b ? diagonal[p] : 0.0);
}

}  // namespace softffd
