#include "model/lobatto.hpp"

#include <algorithm>
#include <cmath>

namespace softffd::lobatto {

namespace {

constexpr double third = 1.0 / 3;

/// Calls patch(numbers of its first node, step) for the four nodes of every patch along an axis, a row of x after the other: of y and z so
/// many lines side by side as the row is long.
template <class Patch>
void each_row(const Lattice& lattice, int axis, double* values, const Patch& patch) {
  const auto& n = lattice.counts;
  const std::ptrdiff_t step = axis == 0 ? 1 : axis == 1 ? n[0] : std::ptrdiff_t(n[0]) * n[1];
  const int across = axis == 2 ? n[1] : n[2];
  const std::ptrdiff_t next = axis == 2 ? n[0] : std::ptrdiff_t(n[0]) * n[1];
  for (int j = 0; j < across; ++j)
    for (int e = 0; e < patches(n[axis]); ++e) {
      double* first = values + j * next + 3 * e * step;
      if (axis > 0) {
        for (int i = 0; i < n[0]; ++i) patch(first + i, step);
      } else {
        for (int k = 0; k < n[1]; ++k) patch(first + k * n[0], step);
      }
    }
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
    each_row(lattice, axis, values, [](double* q, std::ptrdiff_t step) {
      const double begin = q[0], low = q[step], high = q[2 * step], end = q[3 * step];
      q[step] = near * low + far * high + (third * end - begin);
      q[2 * step] = near * high + far * low + (third * begin - end);
    });
}

void to_control_points(const Lattice& lattice, const Points& nodes, Points& control_points) {
  control_points = nodes;
  for (int axis = 0; axis < 3; ++axis) to_control_points(lattice, control_points.col(axis).data());
}

void to_nodes(const Lattice& lattice, Points& forces) {
  for (int c = 0; c < 3; ++c)
    for (int axis = 0; axis < 3; ++axis)
      each_row(lattice, axis, forces.col(c).data(), [](double* f, std::ptrdiff_t step) {
        const double low = f[step], high = f[2 * step];
        f[0] += third * high - low;
        f[3 * step] += third * low - high;
        f[step] = near * low + far * high;
        f[2 * step] = near * high + far * low;
      });
}

}  // namespace softffd::lobatto
