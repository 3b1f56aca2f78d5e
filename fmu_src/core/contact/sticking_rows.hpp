/// Elimination of the contact constraints that stick, in a Newton step of coulomb_rows.hpp: their displacements vanish, so that only the
/// Schur complement of the sliding constraints is left to solve with.
///
/// Numbers, of a body that masses alone hold, are few in explicit steps: plain loops. Measured for 386 vertices that rest on a sphere,
/// panels made a step 1.2 to 1.3 times as long. Blocks of an implicit step may be hundreds: panels of a partial Cholesky factor. Measured
/// for cubes of 10^3 and 13^3 nodes that fall flat, plain loops over blocks made the run 1.15 times as long.
#pragma once
#include "matrix/partial_factor.hpp"
#include "model/types.hpp"

namespace softffd {

/// G (rows, rows) of sticking constraints, which come first, and sliding ones; right sides (rows) of three components each.
template <class Block>
class StickingRows;

template <>
class StickingRows<double> {
 public:
  void resize(int sticking, int rows);
  /// Sets blocks (i, j) and (j, i), i >= j, from block (j, i).
  void set(int i, int j, double block) { g_[j * rows_ + i] = block; }
  void add_to_diagonal(int i, double own) { g_[i * rows_ + i] += own; }
  /// right: becomes that of the Schur complement, for the sliding constraints.
  void eliminate(std::vector<Vec3>& right);
  /// Returns block (i, j), i >= j, of the Schur complement.
  double left(int i, int j) const { return g_[j * rows_ + i]; }
  /// right: the solution for the sliding constraints, becomes that for all.
  void substitute(std::vector<Vec3>& right) const;

 private:
  int sticking_ = 0, rows_ = 0;
  std::vector<double> g_;  ///< upper triangle, row by row; after `eliminate` with the inverse pivots
};

template <>
class StickingRows<Eigen::Matrix3d> {
 public:
  void resize(int sticking, int rows) { factor_.resize(3 * sticking, 3 * (rows - sticking)); }
  void set(int i, int j, const Eigen::Matrix3d& block);
  void add_to_diagonal(int i, double own);
  void eliminate(std::vector<Vec3>& right);
  Eigen::Matrix3d left(int i, int j);
  void substitute(std::vector<Vec3>& right);

 private:
  void put(const std::vector<Vec3>& right);
  void take(std::vector<Vec3>& right);
  PartialFactor factor_;
};

}  // namespace softffd
