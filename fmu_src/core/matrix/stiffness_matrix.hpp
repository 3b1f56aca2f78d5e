/// The energies' second derivatives as a matrix of the lattice.
#pragma once
#include "body/body.hpp"
#include "matrix/lattice_matrix.hpp"

namespace softffd {

/// matrix = the linearisation of all energies at x, plus `diagonal` on the diagonal (points), all [N/m]. Rows and columns of pinned points
/// are those of the identity.
void assemble(const Body& body, const Points& x, const Linearisation& of, const Scalars& diagonal, LatticeMatrix& matrix);

}  // namespace softffd
