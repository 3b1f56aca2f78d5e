/// Chooses samples of a surface that all other vertices follow closely, for the Python package (`softffd/embedding/samples.py`).
///
/// W_v is the vector of the weights of all control points at vertex v. W_v is the product of the weights of each axis, which these
/// functions take as arguments. The scalar product of two such vectors is a product over the axes too.
///
/// The vertex farthest from all samples is sought in blocks of vertices near each other at rest. A block has a middle, a radius about it,
/// and the distance of its farthest vertex. A new sample p can be nearer than the other samples only to vertices of blocks with
///
///     |W_p - W_middle| < radius + distance of the farthest.
///
/// The other blocks are skipped. The choice is the same as in a search through all vertices, with the same bits on every machine.
///
/// A vertex can be behind a plane by e_v = 1/2 |W_v - sum alpha_s W_s|_1 of the lattice's height, for any alpha_s >= 0 that sum to 1. The
/// nearest such combination of the samples nearest to the vertex is found by `least_norm` (Wolfe 1976).
#pragma once
#include "machine/exported.hpp"

/// axes: (3, n, vertices), weights of x, y and z, n of each with zeros where an axis has fewer control points.
/// order: (count), the vertex `first` and then, each time, the vertex farthest from those before; of equals the one with the lower index.
SOFTFFD_EXPORTED void softffd_farthest_first(int n, long long vertices, const double* axes, long long first, long long count,
                                             long long* order);

/// axes: as above. samples: (count), indices of vertices. Returns the largest e_v found, or the first above `allowed`.
SOFTFFD_EXPORTED double softffd_most_behind(int n, long long vertices, const double* axes, long long count, const long long* samples,
                                            double allowed);
