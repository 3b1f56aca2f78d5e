#include "forces/volume.hpp"

#include <cmath>

namespace softffd {

Volume::Volume(const Lattice& lattice, double kappa) : cells_(lattice), rest_volume_(1) {
  for (int axis = 0; axis < 3; ++axis) rest_volume_ *= lattice.size[axis] / (lattice.counts[axis] - 1);
  scale_ = kappa * rest_volume_ / 8;
}

/// Calls visit(corner, J0 - J) for every corner with J < J0; returns whether there was one.
template <class Visit>
bool Volume::visit_crushed(const Points& x, Visit visit) const {
  if (!cells_.any_below(threshold, x)) return false;
  for (int lane = 0; lane < cells_.lanes(); ++lane) {
    if (!(cells_.smallest(lane) < threshold)) continue;
    for (int number = 0; number < 8; ++number) {
      const Cells::Corner corner = cells_.corner(x, lane, number & 1, number >> 1 & 1, number >> 2);
      if (corner.volume < threshold) visit(corner, threshold - corner.volume);
    }
  }
  return true;
}

void Volume::add_force(const Points& x, Points& f) const {
  if (cells_.any_below(threshold, x)) cells_.add_squares(threshold, scale_ / threshold, f);
}

double Volume::energy(const Points& x) const {
  double sum = 0;
  visit_crushed(x, [&](const Cells::Corner&, double missing) { sum += missing * missing * missing; });
  return scale_ / (3 * threshold) * sum;
}

void Volume::subtract_stiffness_product(const Points& x, const Points& u, Points& f) const {
  visit_crushed(x, [&](const Cells::Corner& corner, double missing) {
    double change = 0;
    for (int i = 0; i < 4; ++i) change += corner.gradient[i].dot(row(u, corner.points[i]));
    const double factor = scale_ * 2 * missing / threshold * change;
    for (int i = 0; i < 4; ++i) f.row(corner.points[i]) -= factor * corner.gradient[i].array().transpose();
  });
}

void Volume::add_stiffness(const Points& x, const std::vector<bool>& pinned, LayerMatrix& matrix) const {
  visit_crushed(x, [&](const Cells::Corner& corner, double missing) {
    const double second = scale_ * 2 * missing / threshold;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j <= i; ++j) {
        const int p = corner.points[i], q = corner.points[j];
        if (pinned[p] || pinned[q]) continue;
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < (i == j ? a + 1 : 3); ++b) matrix.at(p, a, q, b) += second * corner.gradient[i][a] * corner.gradient[j][b];
      }
  });
}

bool Volume::add_bounds(const Points& x, const Scalars& mass, const std::vector<bool>& pinned, Scalars& sums) const {
  const int n = int(mass.size());
  return visit_crushed(x, [&](const Cells::Corner& corner, double missing) {
    const double second = scale_ * 2 * missing / threshold, first = scale_ * missing * missing / threshold;
    const auto& [volume, points, gradient] = corner;
    for (int i = 0; i < 4; ++i) {
      const int p = points[i];
      if (pinned[p]) continue;
      double along = 0, across = 0;
      for (int j = 0; j < 4; ++j) {
        if (pinned[points[j]]) continue;
        const double root = std::sqrt(mass[p] / mass[points[j]]);
        along += gradient[j].norm() * root;
        if (j == i) continue;
        const int k = i != 0 && j != 0 ? 0 : i != 1 && j != 1 ? 1 : 2, l = 6 - i - j - k;
        across += (row(x, points[k]) - row(x, points[l])).norm() * root;
      }
      const Vec3& g = gradient[i];
      const double size = g.norm(), c = size > 0 ? second * along / size : 0, e = first * across / rest_volume_;
      for (int a = 0; a < 3; ++a) sums[a * n + p] += c * g[a] * g[a] + e;
      sums[3 * n + p] += c * g[0] * g[1];
      sums[4 * n + p] += c * g[0] * g[2];
      sums[5 * n + p] += c * g[1] * g[2];
    }
  });
}

}  // namespace softffd
