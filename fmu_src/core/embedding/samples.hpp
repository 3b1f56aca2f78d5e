/// Samples of an object's surface that all its other vertices follow closely, for the Python package (`softffd/embedding/samples.py`).
///
/// W_v is the vector of the weights of all control points at vertex v. It is the product of the weights of each axis, which are what these
/// functions take, and so is the scalar product of two of them.
///
/// The vertex farthest from all samples is looked for in blocks of vertices near each other at rest, each with a middle, a radius about it,
/// and the distance of its farthest vertex. A new sample p is nearer than the others only to vertices of blocks with
///
///     |W_p - W_middle| < radius + distance of the farthest,
///
/// the other blocks are left alone: the choice is that of a search through all vertices, in the same bits on every machine.
///
/// Behind a plane, a vertex can be by e_v = 1/2 |W_v - sum alpha_s W_s|_1 of the lattice's height, for any alpha_s >= 0 that sum to 1. The
/// nearest such combination of the samples nearest to the vertex is found by pairwise Frank-Wolfe steps (Lacoste-Julien & Jaggi 2015).
#pragma once
#include "machine/exported.hpp"

/// axes: (3, n, vertices), weights of x, y and z, n of each with zeros where an axis has fewer control points.
/// order: (count), the vertex `first` and then, each time, the one farthest from those before, the lower index of equals.
SOFTFFD_EXPORTED void softffd_farthest_first(int n, long long vertices, const double* axes, long long first, long long count,
                                             long long* order);

/// axes: as above. samples: (count), indices of vertices. Returns the largest e_v found of all vertices, or the first above `allowed`.
SOFTFFD_EXPORTED double softffd_most_behind(int n, long long vertices, const double* axes, long long count, const long long* samples,
                                            double allowed);
