#include "forces/volume.hpp"

#include <cmath>

namespace softffd {

Volume::Volume(const Lattice& lattice, double kappa) : cells_(lattice), rest_volume_(1), edges_(lattice) {
  for (int axis = 0; axis < 3; ++axis) rest_volume_ *= lattice.size[axis] / (lattice.counts[axis] - 1);
  scale_ = kappa * rest_volume_ / 8;
}

void Volume::add_force(const Points& x, Points& f) const { cells_.add_squares(threshold, scale_ / threshold, x, f); }

double Volume::energy(const Points& x) const {
  double sum = 0;
  cells_.visit_below(threshold, x, [&](const Cells::Corner& corner) {
    const double missing = threshold - corner.volume;
    sum += missing * missing * missing;
  });
  return scale_ / (3 * threshold) * sum;
}

void Volume::add_blocks(const Points& x, const Linearisation&, BlockSink& sink) const {
  visit_crushed(x, [&](const Cells::Corner& corner, double second) {
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j <= i; ++j)
        sink.add(corner.points[i], corner.points[j], second * corner.gradient[i] * corner.gradient[j].transpose());
  });
}

void Volume::subtract_product(const Points& x, const Linearisation&, const Points& u, Points& f) const {
  visit_crushed(x, [&](const Cells::Corner& corner, double second) {
    double change = 0;
    for (int i = 0; i < 4; ++i) change += corner.gradient[i].dot(row(u, corner.points[i]));
    const double factor = second * change;
    for (int i = 0; i < 4; ++i) f.row(corner.points[i]) -= factor * corner.gradient[i].array().transpose();
  });
}

bool Volume::add_bounds(const Points& x, const Scalars& mass, const std::vector<bool>& pinned, Scalars& sums) const {
  const int n = int(mass.size());
  return visit_crushed(x, [&](const Cells::Corner& corner, double second) {
    const auto& [volume, points, gradient] = corner;
    const double missing = threshold - volume, first = scale_ * missing * missing / threshold;
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
