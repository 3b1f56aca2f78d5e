/// Many points of the object at once: Q(u, v, w) = sum of p_ijk W_i(u) W_j(v) W_k(w), for the Python package.
///
/// The axes are contracted one after the other, over the control points that count: all of an axis, or four of a B-spline or a patch. Where
/// the same ones count for all points, as in a Bezier volume, as many points as a register holds are worked on at once, and a number of a
/// control point goes to all of them:
///
///      line = sum over i of  W_i(u) p_ijk,    face = sum over j of  W_j(v) line,    Q = sum over k of  W_k(w) face
///
/// Else each point has its own. Four along z lie side by side with their three coordinates, three registers of four numbers:
///
///      p_ij =  | x y z x | y z x y | z x y z |        k, k + 1, k + 2, k + 3
///      line = sum over j of  W_j(v) p_ij,     face = sum over i of  W_i(u) line,    Q = sum over k of  W_k(w) face[k]
///
/// The weights of 32 points are computed at once. Every point has its own sums, in an order that depends on the lattice alone: it has the
/// same bits whichever others are deformed with it, and whatever registers the machine has.
#pragma once
#include "machine/exported.hpp"

/// origin, size: of the box at rest (3) [m]. counts: control points per axis (3), 2 to 32. basis: 0 Bezier, 1 B-splines, 2 patches.
/// control: control points [m] (frames, nx, ny, nz, 3), of fewer than four along z with zeros up to four.
/// rest: (points, 3) [m], in the box. moved: (frames, frame, 3) [m], of which the first `points` of each frame are written.
SOFTFFD_EXPORTED void softffd_deform(const double* origin, const double* size, const int* counts, int basis, long long frames,
                                     const double* control, long long points, const double* rest, long long frame, double* moved);
