#include "model/lobatto.hpp"

#include <algorithm>
#include <cmath>

#include "machine/instructions.hpp"

namespace softffd::kernels {
namespace {

/// Replaces the inner nodes of lines side by side by inner control points.
INNER void side_by_side(int lines, In begin, Out low, Out high, In end) {
  constexpr double third = 1.0 / 3;
  for (int i = 0; i < lines; ++i) {
    const double q1 = low[i], q2 = high[i];
    low[i] = lobatto::near * q1 + lobatto::far * q2 + (third * end[i] - begin[i]);
    high[i] = lobatto::near * q2 + lobatto::far * q1 + (third * begin[i] - end[i]);
  }
}
INNER void lines_to_control_points(double* q, int lines, std::ptrdiff_t apart, std::ptrdiff_t step) {
  if (apart == 1) return side_by_side(lines, q, q + step, q + 2 * step, q + 3 * step);
  for (int i = 0; i < lines; ++i, q += apart) side_by_side(1, q, q + step, q + 2 * step, q + 3 * step);
}
const auto to_control_points = chosen<lines_to_control_points>();

}  // namespace
}  // namespace softffd::kernels

namespace softffd::lobatto {

namespace {

constexpr double third = 1.0 / 3;

/// Calls use(first number, number of lines, distance between lines, distance between nodes) for the four nodes of every patch along an
/// axis. One call covers all lines along x, or all lines along another axis that are side by side.
template <class Use>
void each_lines(const Lattice& lattice, int axis, double* values, const Use& use) {
  const auto& n = lattice.counts;
  const std::ptrdiff_t layer = std::ptrdiff_t(n[0]) * n[1], step = axis == 0 ? 1 : axis == 1 ? n[0] : layer;
  const int lines = axis == 0 ? n[1] * n[2] : axis == 1 ? n[0] : n[0] * n[1];
  for (int k = 0; k < (axis == 1 ? n[2] : 1); ++k)
    for (int e = 0; e < patches(n[axis]); ++e) use(values + k * layer + 3 * e * step, lines, axis == 0 ? n[0] : 1, step);
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

Scalars volume_fractions(const Lattice& lattice) {
  std::array<Scalars, 3> axis;
  for (int a = 0; a < 3; ++a) {
    axis[a] = Scalars::Zero(lattice.counts[a]);
    const int count = patches(lattice.counts[a]);
    for (int patch = 0; patch < count; ++patch)
      for (int i = 0; i < nodes; ++i) axis[a][3 * patch + i] += weights[i] / count;
  }
  Scalars fractions(lattice.points());
  for (int k = 0; k < lattice.counts[2]; ++k)
    for (int j = 0; j < lattice.counts[1]; ++j)
      for (int i = 0; i < lattice.counts[0]; ++i) fractions[lattice.index(i, j, k)] = axis[0][i] * axis[1][j] * axis[2][k];
  return fractions;
}

void to_control_points(const Lattice& lattice, double* values) {
  for (int axis = 0; axis < 3; ++axis) each_lines(lattice, axis, values, kernels::to_control_points);
}

void to_control_points(const Lattice& lattice, const Points& nodes, Points& control_points) {
  control_points = nodes;
  for (int axis = 0; axis < 3; ++axis) to_control_points(lattice, control_points.col(axis).data());
}

void to_nodes(const Lattice& lattice, Points& forces) {
  for (int c = 0; c < 3; ++c)
    for (int axis = 0; axis < 3; ++axis)
      each_lines(lattice, axis, forces.col(c).data(), [](double* f, int lines, std::ptrdiff_t apart, std::ptrdiff_t step) {
        for (int i = 0; i < lines; ++i, f += apart) {
          const double low = f[step], high = f[2 * step];
          f[0] += third * high - low;
          f[3 * step] += third * low - high;
          f[step] = near * low + far * high;
          f[2 * step] = near * high + far * low;
        }
      });
}

}  // namespace softffd::lobatto
