/// Bernstein polynomials and points of the Bezier volume (Xia & Wang 2009, eq. (1) and (2)), any degree.
#pragma once
#include "lattice.hpp"

namespace softffd {

/// B_0..B_{n-1} of degree n - 1 at t, by de Casteljau's recurrence: exact sum to rounding for any n >= 1. Returns (n).
Scalars bernstein(double t, int n);

/// Weights w_p with Q(u,v,w) = sum_p w_p p_p at the point `at` [m] of the rest configuration. Returns (points).
Scalars embedding_weights(const Lattice& lattice, const Vec3& at);

}  // namespace softffd
