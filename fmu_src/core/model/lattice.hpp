/// The rest lattice of control points of a Bezier volume (Xia & Wang 2009, section 1.1).
///
/// Control point p_ijk has the flat index p = i + nx (j + ny k): x is fastest. Its neighbours within one cell lie in 26 directions, 13 of
/// them up to sign; along one direction every neighbour is the same number of places away in memory (`offset`), which is what the
/// spring kernels are built on:
///
///      direction (1,0,0): offset 1          (0,1,0): offset nx         (0,0,1): offset nx ny
///      direction (1,1,0): offset 1 + nx     (-1,1,0): offset nx - 1    ...
#pragma once
#include <algorithm>
#include <array>
#include <vector>

#include "model/types.hpp"

namespace softffd {

/// Largest number of control points per axis, and largest distance in memory from a point to a neighbour.
inline constexpr int most_points = 32, farthest_neighbour = 1 + most_points * (1 + most_points);

struct Lattice {
  std::array<int, 3> counts{4, 4, 4};  ///< control points per axis, 2 to most_points
  Vec3 origin = Vec3::Zero();          ///< lower corner of the box [m]
  Vec3 size = Vec3::Ones();            ///< sides of the box, > 0 [m]
  bool lobatto = false;                ///< points of a body of finite elements, which are not equally spaced (lobatto.hpp)

  int points() const { return counts[0] * counts[1] * counts[2]; }
  int index(int i, int j, int k) const { return i + counts[0] * (j + counts[1] * k); }
  Vec3 centre() const { return origin + 0.5 * size; }
  double largest_side() const { return size.maxCoeff(); }
  /// Sides of a cell [m].
  Vec3 cell() const { return size.cwiseQuotient(Vec3(counts[0] - 1, counts[1] - 1, counts[2] - 1)); }
  /// Returns the number of points of a plane across the longest axis.
  int points_across() const { return points() / *std::max_element(counts.begin(), counts.end()); }
  int cells() const { return (counts[0] - 1) * (counts[1] - 1) * (counts[2] - 1); }
};

/// Returns, for every point, the points that elements couple it with, (points): within one cell, or for a solid within its patches.
std::vector<std::vector<int>> coupled_points(const Lattice& lattice);

/// Returns the rest positions X [m], (points, 3).
Points rest_positions(const Lattice& lattice);

enum class SpringKind { edge, face, body };

/// One of the 13 directions from a control point to a neighbour of higher index.
struct Direction {
  int di, dj, dk;
  SpringKind kind() const { return SpringKind(di * di + dj * dj + dk * dk - 1); }
  int offset(const Lattice& lattice) const { return lattice.index(di, dj, dk); }
  /// True if point (i, j, k) has a neighbour in this direction.
  bool within(const Lattice& lattice, int i, int j, int k) const {
    const auto& n = lattice.counts;
    return i + di >= 0 && i + di < n[0] && j + dj >= 0 && j + dj < n[1] && k + dk < n[2];
  }
};

/// Edges first, then face diagonals, then body diagonals.
inline constexpr std::array<Direction, 13> directions{{{1, 0, 0},
                                                       {0, 1, 0},
                                                       {0, 0, 1},
                                                       {1, 1, 0},
                                                       {-1, 1, 0},
                                                       {1, 0, 1},
                                                       {-1, 0, 1},
                                                       {0, 1, 1},
                                                       {0, -1, 1},
                                                       {1, 1, 1},
                                                       {-1, 1, 1},
                                                       {1, -1, 1},
                                                       {-1, -1, 1}}};

}  // namespace softffd
