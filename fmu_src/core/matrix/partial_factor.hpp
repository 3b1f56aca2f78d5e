/// Partial Cholesky factor of a symmetric matrix: the first unknowns are eliminated, and the Schur complement of the others is left.
///
///      ( A11  .  )     A11 = L L',  B = A21 L'^-1,  S = A22 - B B'      A11 is positive definite.
///      ( A21 A22 )
///
/// The loops (panels.hpp) give the same bits on every instruction set.
#pragma once
#include <vector>

namespace softffd {

class PartialFactor {
 public:
  /// Sets all entries to 0. first: number of unknowns to eliminate; others: number of the rest.
  void resize(int first, int others);
  /// Entry (i, j) of the lower triangle, i >= j: of A before `factor`; afterwards, for i and j not among the first unknowns, of S.
  double& operator()(int i, int j) { return values_[at(j) * stride_ + at(i)]; }
  void factor();
  /// Entry i of the right-hand side. After `eliminate`, the entries of the other unknowns are the right-hand side for S. Before
  /// `substitute`, they have to be the solution with S; afterwards, `right` is the whole solution.
  double& right(int i) { return right_[at(i)]; }
  void eliminate();
  void substitute();

 private:
  int at(int i) const { return i < first_ ? i : i - first_ + own_; }

  int first_ = 0, own_ = 0, rows_ = 0;  ///< unknowns to eliminate; the same rounded up to whole panels; all, rounded up
  std::size_t stride_ = 0;
  std::vector<double> values_, inverse_, right_;  ///< by columns; 1 / diagonal of L
};

}  // namespace softffd
