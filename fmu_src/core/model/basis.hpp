/// Basis functions: how much each control point counts at a point of the object.
///
/// At rest the n control points of an axis are equally spaced, c_i = i / (n - 1). The weights W_i(t) at a position t from 0 to 1 are not
/// negative, sum to one and reproduce the position, sum W_i c_i = t. Therefore the undeformed object is itself, and the deformed object
/// stays in the convex hull of the control points.
///
/// Bezier volume (Xia & Wang 2009, eq. (1) and (2)): Bernstein polynomials of degree n - 1. B-splines: uniform, cubic, clamped, with knots
/// 0, 0, 0, 0, 1, .., L, L, L, L, L = n - 3. The B-splines themselves do not reproduce positions,
///
///      X(s) = sum N_i(s) c_i       is (s + 1) / (n - 1) in the middle, and three times as steep as that at the ends,
///
/// so that the weights at t are the B-splines at the parameter s with X(s) = t. Up to four control points, both bases are the same.
///
/// Patches: a body of finite elements consists of adjacent Bezier volumes of four control points per axis. The core's points are the nodes
/// of the patches (lobatto.hpp), so the weights are those of nodes. They may be negative: along an axis they are at least -1/8.
#pragma once
#include <vector>

#include "model/lattice.hpp"

namespace softffd {

enum class Basis { bezier, bspline, patches };

/// Returns the weights (n) of the n >= 1 control points of an axis at the position t.
Scalars weights(Basis basis, double t, int n);

/// A point of the object: the control points that support it, and their weights.
struct Embedding {
  std::vector<int> points;
  std::vector<double> weights;
  /// Returns the weighted sum of the values of the control points, (all points).
  template <class Values>
  double operator()(const Values& values) const {
    double sum = 0;
    for (std::size_t i = 0; i < points.size(); ++i) sum += weights[i] * values[points[i]];
    return sum;
  }
};

/// Returns the point whose rest position is `at` [m].
Embedding embed(Basis basis, const Lattice& lattice, const Vec3& at);

}  // namespace softffd
