#include "matrix/stiffness_matrix.hpp"

#include "matrix/spring_assembly.hpp"
#include "matrix/volume_hessian.hpp"

namespace softffd {

void assemble(const Body& body, const Points& x, const Scalars& diagonal, Scalars& sums, LatticeMatrix& matrix) {
  double* bounds = body.springs.scratch();
  matrix.clear();
  sums.setZero();
  for (const Springs::Row& row : body.springs.rows()) {
    const double* k = row.stiffness.data();
    kernels::add_stiffness_bounds(row.view(), body.points(), x.data(), k, k, sums.data(), bounds);
    set_couplings(body, row, matrix, [&](int lane, int component) { return k[lane] * bounds[component * row.lanes() + lane]; });
  }
  set_diagonal_blocks(body, sums, diagonal, matrix);
  if (body.volume) add_stiffness(*body.volume, x, body.pinned, matrix);
}

void stiffness_force(const Body& body, const Points& x, const Points& u, Points& f) {
  f.setZero();
  for (const Springs::Row& row : body.springs.rows())
    kernels::subtract_stiffness_product(row.view(), int(x.rows()), x.data(), u.data(), f.data(), body.springs.scratch());
  if (body.volume) subtract_stiffness_product(*body.volume, x, u, f);
}

}  // namespace softffd
