/// Basis functions: how much each control point counts at a point of the object.
///
/// At rest the n control points of an axis stand at equal distances, c_i = i / (n - 1). The weights W_i(t) at a place t from 0 to 1 are not
/// negative, sum to one and reproduce the place, sum W_i c_i = t: the undeformed object is itself, the deformed one stays in the convex
/// hull of the control points.
///
/// Bezier volume (Xia & Wang 2009, eq. (1) and (2)): Bernstein polynomials of degree n - 1. B-splines: uniform, cubic, clamped, with knots
/// 0, 0, 0, 0, 1, .., L, L, L, L, L = n - 3. These do not reproduce places,
///
///      X(s) = sum N_i(s) c_i       is (s + 1) / (n - 1) in the middle, and three times as steep as that at the ends,
///
/// so that a place t takes the weights at the parameter s with X(s) = t. With up to four control points both are the same.
///
/// Patches: Bezier volumes of four control points an axis side by side, of a body of finite elements. Its points in the core are the nodes
/// of the patches (lobatto.hpp), and so the weights are those of nodes, which may be negative: -1/8 along an axis at least.
#pragma once
#include <vector>

#include "model/lattice.hpp"

namespace softffd {

enum class Basis { bezier, bspline, patches };

/// Weights of the n >= 1 control points of an axis at the place t. Returns (n).
Scalars weights(Basis basis, double t, int n);

/// A point of the object: the control points that count there, and how much.
struct Embedding {
  std::vector<int> points;
  std::vector<double> weights;
  /// Sum of the weights times the values of the control points, (all points).
  template <class Values>
  double operator()(const Values& values) const {
    double sum = 0;
    for (std::size_t i = 0; i < points.size(); ++i) sum += weights[i] * values[points[i]];
    return sum;
  }
};

/// The point that is at `at` [m] in the rest configuration.
Embedding embed(Basis basis, const Lattice& lattice, const Vec3& at);

}  // namespace softffd
