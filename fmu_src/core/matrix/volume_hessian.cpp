#include "matrix/volume_hessian.hpp"

namespace softffd {

void subtract_stiffness_product(const Volume& volume, const Points& x, const Points& u, Points& f) {
  volume.visit_crushed(x, [&](const Cells::Corner& corner, double second) {
    double change = 0;
    for (int i = 0; i < 4; ++i) change += corner.gradient[i].dot(row(u, corner.points[i]));
    const double factor = second * change;
    for (int i = 0; i < 4; ++i) f.row(corner.points[i]) -= factor * corner.gradient[i].array().transpose();
  });
}

void add_stiffness(const Volume& volume, const Points& x, const std::vector<bool>& pinned, LatticeMatrix& matrix) {
  volume.visit_crushed(x, [&](const Cells::Corner& corner, double second) {
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j <= i; ++j) {
        const int p = corner.points[i], q = corner.points[j];
        if (pinned[p] || pinned[q]) continue;
        Mat3 block;
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < 3; ++b) block(a, b) = second * corner.gradient[i][a] * corner.gradient[j][b];
        matrix.add_block(p, q, block);
      }
  });
}

}  // namespace softffd
