#include "model/basis.hpp"

#include <algorithm>
#include <cmath>

namespace softffd {

namespace {

/// Newton steps for X(s) = t; five reach rounding for every n.
constexpr int newton_steps = 6;

/// By de Casteljau's recurrence: exact sum to rounding for any n.
Scalars bernstein(double t, int n) {
  Scalars weights = Scalars::Zero(n);
  weights[0] = 1;
  for (int degree = 1; degree < n; ++degree) {
    for (int i = degree; i > 0; --i) weights[i] = (1 - t) * weights[i] + t * weights[i - 1];
    weights[0] *= 1 - t;
  }
  return weights;
}

/// The four B-splines that are not zero at a parameter, from number `first` on.
struct Span {
  int first;
  std::array<double, 4> values;
  double slope;                                                                         ///< (n - 1) dX/ds
  double place() const { return first + (values[1] + 2 * values[2] + 3 * values[3]); }  ///< (n - 1) X
};

/// By the recurrence of Cox (1972) and de Boor (1972), whose terms are all positive; n > 4.
Span bsplines(double s, int n) {
  const int spans = n - 3;
  Span span{std::clamp(int(std::floor(s)), 0, spans - 1), {1, 0, 0, 0}, 0};
  const auto behind = [&](int p) { return s - std::max(span.first + 1 - p, 0); };
  const auto ahead = [&](int p) { return std::min(span.first + p, spans) - s; };
  for (int degree = 1; degree <= 3; ++degree) {
    double rising = 0;
    span.slope = 0;
    for (int r = 0; r < degree; ++r) {
      const double part = span.values[r] / (ahead(r + 1) + behind(degree - r));
      span.values[r] = rising + ahead(r + 1) * part;
      rising = behind(degree - r) * part;
      span.slope += degree * part;
    }
    span.values[degree] = rising;
  }
  return span;
}

/// Newton's method for X(s) = t, from s as in the middle: on the side from which the curvature of X makes it approach the solution without
/// passing it.
Span span_at(double t, int n) {
  const double wanted = t * (n - 1);
  double s = std::clamp(wanted - 1, 0.0, double(n - 3));
  for (int i = 0; i < newton_steps; ++i) {
    const Span span = bsplines(s, n);
    s += (wanted - span.place()) / span.slope;
  }
  return bsplines(s, n);
}

}  // namespace

Scalars weights(Basis basis, double t, int n) {
  if (basis == Basis::bezier || n <= 4) return bernstein(t, n);
  const Span span = span_at(t, n);
  Scalars weights = Scalars::Zero(n);
  for (int r = 0; r < 4; ++r) weights[span.first + r] = span.values[r];
  return weights;
}

Embedding embed(Basis basis, const Lattice& lattice, const Vec3& at) {
  std::array<Scalars, 3> axis;
  for (int a = 0; a < 3; ++a) axis[a] = weights(basis, (at[a] - lattice.origin[a]) / lattice.size[a], lattice.counts[a]);
  Embedding embedding;
  for (int k = 0; k < lattice.counts[2]; ++k)
    for (int j = 0; j < lattice.counts[1]; ++j)
      for (int i = 0; i < lattice.counts[0]; ++i) {
        const double weight = axis[0][i] * axis[1][j] * axis[2][k];
        if (weight == 0) continue;
        embedding.points.push_back(lattice.index(i, j, k));
        embedding.weights.push_back(weight);
      }
  return embedding;
}

}  // namespace softffd
