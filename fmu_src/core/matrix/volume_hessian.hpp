/// The positive semidefinite part K of the volume stiffness' second derivatives (volume.hpp): A phi'' g g^T of every corner that resists.
#pragma once
#include "forces/volume.hpp"
#include "matrix/lattice_matrix.hpp"

namespace softffd {

/// f -= K u with K at x [N]; u [m], (points, 3).
void subtract_stiffness_product(const Volume& volume, const Points& x, const Points& u, Points& f);
/// matrix += K at x [N/m]; rows and columns of pinned points are left alone.
void add_stiffness(const Volume& volume, const Points& x, const std::vector<bool>& pinned, LatticeMatrix& matrix);

}  // namespace softffd
