#include "matrix/stiffness_matrix.hpp"

namespace softffd {

namespace {

constexpr int component[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};  // of xx yy zz xy xz yz

/// The kernel has left the lanes' matrices without stiffness in the springs' scratch.
void couple(const Body& body, const Springs::Row& row, LayerMatrix& matrix) {
  const double* scratch = body.springs.scratch();
  for (int lane = 0; lane < row.lanes(); ++lane) {
    const int p = row.begin + lane, q = p + row.offset;
    if (row.stiffness[lane] == 0 || body.pinned[p] || body.pinned[q]) continue;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) matrix.at(p, a, q, b) = -row.stiffness[lane] * scratch[component[a][b] * row.lanes() + lane];
  }
}

}  // namespace

void assemble(const Body& body, const Points& x, const Scalars& diagonal, Scalars& sums, LayerMatrix& matrix) {
  const int n = body.points();
  matrix.clear();
  sums.setZero();
  for (const Springs::Row& row : body.springs.rows()) {
    const double* k = row.stiffness.data();
    kernels::add_stiffness_bounds(row.view(), n, x.data(), k, k, sums.data(), body.springs.scratch());
    couple(body, row, matrix);
  }
  for (int p = 0; p < n; ++p)
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b <= a; ++b)
        matrix.at(p, a, p, b) = body.pinned[p] ? a == b : sums[component[a][b] * n + p] + (a == b ? diagonal[p] : 0.0);
  if (body.volume) body.volume->add_stiffness(x, body.pinned, matrix);
}

void stiffness_force(const Body& body, const Points& x, const Points& u, Points& f) {
  f.setZero();
  for (const Springs::Row& row : body.springs.rows())
    kernels::subtract_stiffness_product(row.view(), int(x.rows()), x.data(), u.data(), f.data(), body.springs.scratch());
  if (body.volume) body.volume->subtract_stiffness_product(x, u, f);
}

}  // namespace softffd
