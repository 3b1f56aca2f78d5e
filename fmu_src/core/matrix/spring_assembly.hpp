/// How the springs' 3 x 3 matrices become a matrix of the lattice. Each is symmetric and stands as its six components xx yy zz xy xz yz,
/// every component of all lanes in one run; a spring's matrix is in the diagonal blocks of both its ends, and negative between them.
#pragma once
#include "body/body.hpp"
#include "matrix/lattice_matrix.hpp"

namespace softffd {

/// Between the ends of a row's springs: minus entry(lane, component) [N/m]. Pinned points are left alone.
template <class Entry>
void set_couplings(const Body& body, const Springs::Row& row, LatticeMatrix& matrix, Entry entry) {
  for (int lane = 0; lane < row.lanes(); ++lane) {
    const int p = row.begin + lane, q = p + row.offset;
    if (row.stiffness[lane] == 0 || body.pinned[p] || body.pinned[q]) continue;
    Mat3 block;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) block(a, b) = -entry(lane, component[a][b]);
    matrix.set_block(p, q, block);
  }
}

/// The diagonal blocks: sums of all springs at a point (6 * points) and `diagonal` (points) [N/m]; of pinned points the identity.
void set_diagonal_blocks(const Body& body, const Scalars& sums, const Scalars& diagonal, LatticeMatrix& matrix);

}  // namespace softffd
