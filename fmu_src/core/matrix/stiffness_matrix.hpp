/// The springs' stiffness matrix, each spring by the nearest positive semidefinite bound of its Hessian,
///
///      k (u u^T + max(0, 1 - l/r) (I - u u^T)),      u: unit vector along the spring, r its length, l its rest length,
///
/// so that no state of the springs makes a system indefinite; at r = 0, where there is no direction, nothing. Of the volume stiffness,
/// where there is one, the positive semidefinite part (volume.hpp).
#pragma once
#include "body/body.hpp"
#include "matrix/lattice_matrix.hpp"

namespace softffd {

/// matrix = K + C per_time at x, plus `diagonal` on the diagonal (points), all [N/m]; C: the dashpots', per_time [1/s]. Rows and columns of
/// pinned points are those of the identity. sums: (6 * points), scratch.
void assemble(const Body& body, const Points& x, const Scalars& diagonal, Scalars& sums, LatticeMatrix& matrix, double per_time = 0);

/// f = -K u with K at x [N], all points; u [m], (points, 3).
void stiffness_force(const Body& body, const Points& x, const Points& u, Points& f);

}  // namespace softffd
