/// Deforms many points of the object at once, for the Python package: Q(u, v, w) = sum of p_ijk W_i(u) W_j(v) W_k(w).
///
/// The axes are contracted one after the other, over the control points that contribute: all of an axis, or four of a B-spline or a
/// patch. If the same control points contribute to all points, as in a Bezier volume, as many points as a register holds are processed at
/// once, and each coordinate of a control point is used for all of them:
///
///      line = sum over i of  W_i(u) p_ijk,    face = sum over j of  W_j(v) line,    Q = sum over k of  W_k(w) face
///
/// Otherwise each point has its own control points. Four along z, with their three coordinates, fill three registers of four numbers:
///
///      p_ij =  | x y z x | y z x y | z x y z |        k, k + 1, k + 2, k + 3
///      line = sum over j of  W_j(v) p_ij,     face = sum over i of  W_i(u) line,    Q = sum over k of  W_k(w) face[k]
///
/// The weights of 32 points are computed at once. Every point has its own sums, in an order that depends on the lattice alone: the bits
/// of a point depend neither on the other points that are deformed with it nor on the registers of the machine.
#pragma once
#include "machine/exported.hpp"

/// origin, size: of the box at rest (3) [m]. counts: control points per axis (3), 2 to 32. basis: 0 Bezier, 1 B-splines, 2 patches.
/// control: control points [m] (frames, nx, ny, nz, 3); fewer than four along z are filled up to four with zeros.
/// rest: (points, 3) [m], in the box. moved: (frames, frame, 3) [m], of which the first `points` of each frame are written.
SOFTFFD_EXPORTED void softffd_deform(const double* origin, const double* size, const int* counts, int basis, long long frames,
                                     const double* control, long long points, const double* rest, long long frame, double* moved);
