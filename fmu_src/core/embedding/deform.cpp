#include "embedding/deform.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "machine/lanes.hpp"
#include "model/basis_formulas.hpp"

namespace {

using namespace softffd;
using kernels::In;
using kernels::Lanes;
using kernels::load;

constexpr int together = 32;
constexpr int most = 32;  // largest number of control points of an axis
enum : int { bezier, bspline, patches };
using Step = std::ptrdiff_t;

/// Weights at some points along one axis: `count` control points from `first` on contribute to each of them.
struct Axis {
  double weights[most][together];
  double first[together];
  int count;
};

INNER void place(const double* t, int n, int basis, Axis& axis) {
  axis.count = n;
  if (basis == bezier || n <= 4) {
    for (int at = 0; at < together; ++at) axis.first[at] = 0;
    formulas::bernstein<together>(t, n, axis.weights);
  } else if (basis == patches) {
    axis.count = 4;
    double s[together];
    for (int at = 0; at < together; ++at) {
      s[at] = t[at] * (n / 3);
      const double patch = formulas::smaller(formulas::larger(formulas::rounded_down(s[at]), 0), n / 3 - 1);
      axis.first[at] = 3 * patch;
      s[at] -= patch;
    }
    formulas::bernstein<together>(s, 4, axis.weights);
  } else {
    axis.count = 4;
    double s[together];
    for (int at = 0; at < together; ++at) s[at] = formulas::parameter(t[at], n);
    for (int at = 0; at < together; ++at) {
      const formulas::Span span = formulas::bsplines(s[at], n);
      axis.first[at] = span.first;
      for (int r = 0; r < 4; ++r) axis.weights[r][at] = span.values[r];
    }
  }
  for (int r = axis.count; r % 4 != 0; ++r)
    for (int at = 0; at < together; ++at) axis.weights[r][at] = 0;
}

/// Deforms `n` points, from number `at` of those together, to which the same control points contribute: nx, ny and nz of them. line,
/// face: distance in `control` from one control point to the next along y and along x.
template <int n>
INNER void contract_some(const Axis* axes, int at, int nx, int ny, int nz, In control, Step line, Step face, double* moved) {
  Lanes<n> sum[3] = {};
  for (int k = 0; k < nz; ++k) {
    Lanes<n> faces[3] = {};
    for (int j = 0; j < ny; ++j) {
      Lanes<n> lines[3] = {};
      for (int i = 0; i < nx; ++i)
        for (int c = 0; c < 3; ++c) lines[c] += load<n>(&axes[0].weights[i][at]) * control[i * face + j * line + 3 * k + c];
      for (int c = 0; c < 3; ++c) faces[c] += load<n>(&axes[1].weights[j][at]) * lines[c];
    }
    for (int c = 0; c < 3; ++c) sum[c] += load<n>(&axes[2].weights[k][at]) * faces[c];
  }
  for (int p = 0; p < 3 * n; ++p) moved[p] = sum[p % 3][p / 3];
}

/// Deforms one point, number `at` of those together, to which nx, ny and four control points contribute, from `control` on. Processes n
/// numbers at a time.
template <int n>
INNER void contract_one(const Axis* axes, int at, int nx, int ny, In control, Step line, Step face, double* moved) {
  double sum[3] = {};
  Lanes<n> faces[12 / n] = {};
  for (int i = 0; i < nx; ++i) {
    Lanes<n> lines[12 / n] = {};
    for (int j = 0; j < ny; ++j)
      for (int q = 0; q < 12 / n; ++q) lines[q] += axes[1].weights[j][at] * load<n>(control + i * face + j * line + n * q);
    for (int q = 0; q < 12 / n; ++q) faces[q] += axes[0].weights[i][at] * lines[q];
  }
  for (int p = 0; p < 12; ++p) sum[p % 3] += axes[2].weights[p / 3][at] * faces[p / n][p % n];
  for (int c = 0; c < 3; ++c) moved[c] = sum[c];
}

template <int n>
INNER void deform(const double* origin, const double* size, const int* counts, int basis, long long frames, const double* control,
                  long long points, const double* rest, long long frame, double* moved) {
  const Step line = 3 * std::max(counts[2], 4), face = counts[1] * line, whole = counts[0] * face;
  const bool alike = basis == bezier || std::max({counts[0], counts[1], counts[2]}) <= 4;
  constexpr int few = n < 4 ? n : 4;
  Axis axes[3];
  double last[3 * together];
  for (long long begin = 0; begin < points; begin += together) {
    const int here = int(std::min<long long>(together, points - begin));
    const double* own = rest + 3 * begin;
    if (here < together) {  // the points that are missing stand at the origin
      for (int at = 0; at < together; ++at)
        for (int a = 0; a < 3; ++a) last[3 * at + a] = at < here ? own[3 * at + a] : origin[a];
      own = last;
    }
    for (int a = 0; a < 3; ++a) {
      double t[together];
      for (int at = 0; at < together; ++at) t[at] = (own[3 * at + a] - origin[a]) / size[a];
      place(t, counts[a], basis, axes[a]);
    }
    const int nx = axes[0].count, ny = axes[1].count, nz = axes[2].count;
    for (long long f = 0; f < frames; ++f) {
      const double* points = control + f * whole;
      double found[3 * together];
      if (alike && nx == 4 && ny == 4 && nz == 4)
        for (int at = 0; at < here; at += n) contract_some<n>(axes, at, 4, 4, 4, points, line, face, found + 3 * at);
      else if (alike)
        for (int at = 0; at < here; at += n) contract_some<n>(axes, at, nx, ny, nz, points, line, face, found + 3 * at);
      else
        for (int at = 0; at < here; ++at) {
          const Step first = int(axes[0].first[at]) * face + int(axes[1].first[at]) * line + 3 * int(axes[2].first[at]);
          contract_one<few>(axes, at, nx, ny, points + first, line, face, found + 3 * at);
        }
      std::memcpy(moved + 3 * (f * frame + begin), found, 3 * here * sizeof(double));
    }
  }
}

const auto deform_here = kernels::chosen<deform<2>, deform<4>, deform<8>>();

}  // namespace

void softffd_deform(const double* origin, const double* size, const int* counts, int basis, long long frames, const double* control,
                    long long points, const double* rest, long long frame, double* moved) {
  deform_here(origin, size, counts, basis, frames, control, points, rest, frame, moved);
}
