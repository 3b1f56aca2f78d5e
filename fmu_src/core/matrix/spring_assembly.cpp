#include "matrix/spring_assembly.hpp"

namespace softffd {

void set_diagonal_blocks(const Body& body, const Scalars& sums, const Scalars& diagonal, LatticeMatrix& matrix) {
  const int n = body.points();
  for (int p = 0; p < n; ++p) {
    Mat3 block = Mat3::Identity();
    if (!body.pinned[p])
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) block(a, b) = sums[component[a][b] * n + p] + (a == b ? diagonal[p] : 0.0);
    matrix.set_block(p, p, block);
  }
}

}  // namespace softffd
