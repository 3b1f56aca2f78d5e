#include "model/lobatto.hpp"

#include <algorithm>
#include <cmath>

namespace softffd::lobatto {

namespace {

constexpr double third = 1.0 / 3;

/// Calls line(first, step) for every line of numbers along an axis.
template <class Line>
void each_line(const Lattice& lattice, int axis, const Line& line) {
  const auto& n = lattice.counts;
  const int step = axis == 0 ? 1 : axis == 1 ? n[0] : n[0] * n[1];
  for (int p = 0; p < lattice.points(); ++p)
    if (p / step % n[axis] == 0) line(p, step);
}

}  // namespace

double place(int i, int n) {
  const int patch = std::min(i / 3, patches(n) - 1);
  return (patch + places[i - 3 * patch]) / patches(n);
}

Scalars interpolation(double t, int n) {
  Scalars all = Scalars::Zero(n);
  const int patch = std::clamp(int(std::floor(t * patches(n))), 0, patches(n) - 1);
  const double u = t * patches(n) - patch;
  for (int i = 0; i < nodes; ++i) {
    double weight = 1;
    for (int j = 0; j < nodes; ++j)
      if (j != i) weight *= (u - places[j]) / (places[i] - places[j]);
    all[3 * patch + i] = weight;
  }
  return all;
}

Scalars volume_shares(const Lattice& lattice) {
  std::array<Scalars, 3> axis;
  for (int a = 0; a < 3; ++a) {
    axis[a] = Scalars::Zero(lattice.counts[a]);
    const int count = patches(lattice.counts[a]);
    for (int patch = 0; patch < count; ++patch)
      for (int i = 0; i < nodes; ++i) axis[a][3 * patch + i] += weights[i] / count;
  }
  Scalars shares(lattice.points());
  for (int k = 0; k < lattice.counts[2]; ++k)
    for (int j = 0; j < lattice.counts[1]; ++j)
      for (int i = 0; i < lattice.counts[0]; ++i) shares[lattice.index(i, j, k)] = axis[0][i] * axis[1][j] * axis[2][k];
  return shares;
}

void to_control_points(const Lattice& lattice, double* values) {
  for (int axis = 0; axis < 3; ++axis)
    each_line(lattice, axis, [&](int first, int step) {
      double* q = values + first;
      for (int patch = 0; patch < patches(lattice.counts[axis]); ++patch, q += 3 * step) {
        const double begin = q[0], low = q[step], high = q[2 * step], end = q[3 * step];
        q[step] = near * low + far * high + (third * end - begin);
        q[2 * step] = near * high + far * low + (third * begin - end);
      }
    });
}

void to_control_points(const Lattice& lattice, const Points& nodes, Points& control_points) {
  control_points = nodes;
  for (int axis = 0; axis < 3; ++axis) to_control_points(lattice, control_points.col(axis).data());
}

void to_nodes(const Lattice& lattice, Points& forces) {
  for (int axis = 0; axis < 3; ++axis)
    each_line(lattice, axis, [&](int first, int step) {
      for (int patch = 0; patch < patches(lattice.counts[axis]); ++patch, first += 3 * step)
        for (int c = 0; c < 3; ++c) {
          double *f = &forces(first, c), &one = f[step], &two = f[2 * step];
          const double low = one, high = two;
          f[0] += third * high - low;
          f[3 * step] += third * low - high;
          one = near * low + far * high;
          two = near * high + far * low;
        }
    });
}

}  // namespace softffd::lobatto
