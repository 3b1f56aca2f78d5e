/// Symmetric positive definite matrices of the lattice and their Cholesky factor by the multifrontal method (Duff & Reid 1983), front by
/// front (dissection.hpp).
///
/// A row of a front has three unknowns. A front stores the columns of its own rows, each with all rows of the front: at first the entries
/// of the matrix, in the end the factor. Elimination leaves an update matrix for the boundary, a dense lower triangle (`left`), which is
/// added to the columns of the parent and to the update matrix of the parent:
///
///          own        boundary
///        [ L         ]               own rows and boundary rows are padded to a multiple of eight, own ones with ones on the diagonal
///        [ L     left ]              left -= L L^T, then left is added to the parent
///
/// For n x n x n points a factor takes 80 to 110 n^6 multiplications and stores 80 to 90 n^4 numbers. Elimination layer by layer would
/// take 30 n^7 multiplications (springs) or 280 n^7 (solids, three planes at a time). The loops (panels.hpp) give the same bits on every
/// instruction set.
#pragma once
#include <memory>
#include <span>
#include <vector>

#include "forces/blocks.hpp"
#include "matrix/dissection.hpp"

namespace softffd {

class DissectedMatrix {
 public:
  /// Allocates the memory, which `clear` is the first to touch.
  explicit DissectedMatrix(const Lattice& lattice);

  void clear();
  /// Returns the block of two coupled points, or of one. Only one triangle is stored: block (p, q) is the transpose of block (q, p).
  Mat3 block(int p, int q) const;
  /// Sets the block of two coupled points, or the symmetric block of one point.
  void set_block(int p, int q, const Mat3& block) {
    visit(p, q, [&](int a, int b, double& entry) { entry = block(a, b); });
  }
  void add_block(int p, int q, const Mat3& block) {
    visit(p, q, [&](int a, int b, double& entry) { entry += block(a, b); });
  }

  /// Computes the Cholesky factor in place. The factor contains NaN if the matrix is not positive definite to rounding.
  void factor();
  /// b <- A^-1 b, (points, 3), with the factor.
  void solve(Points& b);
  /// The same for up to `together` right-hand sides; their bits do not depend on which sides are solved together. The forward substitution
  /// skips a front if its own values are zero in all sides.
  static constexpr std::size_t together = 8;
  void solve_together(std::span<Points* const> sides);

 private:
  struct Free {
    void operator()(double* values) const;
  };
  using Values = std::unique_ptr<double[], Free>;
  /// Where the numbers of a front are stored.
  struct Block {
    int own, rows;        ///< numbers of unknowns, with padding
    std::size_t stride;   ///< between columns
    std::size_t columns;  ///< start in values_
    std::size_t left;     ///< start in left_; columns there are rows - own apart
    int first;            ///< index of its first own unknown among all
  };
  static Values taken(std::size_t count);
  /// Returns the first unknown of a row, counted within the front.
  static int unknown(const Dissection::Front& front, const Block& block, int row) {
    return row < front.own ? 3 * row : block.own + 3 * (row - front.own);
  }
  /// Returns where the block of two points, or of one, begins in the columns of the point that is eliminated first.
  double* entries(int of_columns, int of_rows) const {
    const int f = order_.front(of_columns);
    const Dissection::Front& front = order_.fronts()[f];
    const Block& block = blocks_[f];
    const int row = order_.front(of_rows) == f ? order_.row(of_rows) : order_.row(front, of_rows);
    return values_.get() + block.columns + 3 * order_.row(of_columns) * block.stride + unknown(front, block, row);
  }
  /// Visits all nine entries of a block. The block of one point has entries in both triangles, of which the lower ones have a meaning.
  template <class Visit>
  void visit(int p, int q, Visit visit) const {
    if (first_[p] < first_[q]) {
      each(entries(p, q), stride(p), visit);
    } else {
      each(entries(q, p), stride(q), [&](int a, int b, double& entry) { visit(b, a, entry); });
    }
  }
  std::size_t stride(int p) const { return blocks_[order_.front(p)].stride; }
  template <class Visit>
  static void each(double* column, std::size_t stride, Visit visit) {
    for (int a = 0; a < 3; ++a, column += stride)
      for (int b = 0; b < 3; ++b) visit(a, b, column[b]);
  }
  void add_to_parent(const Dissection::Front& front, const Block& block);
  template <int sides, class Lower, class Upper>
  void substitute(double* unknowns, double* local, Lower lower, Upper upper) const;
  template <int sides>
  void take(const Dissection::Front& front, const Block& block, const double* unknowns, double* local) const;
  template <int sides>
  void give(const Dissection::Front& front, const Block& block, const double* local, double* unknowns, bool boundary) const;

  Dissection order_;
  std::vector<Block> blocks_;  ///< of each front
  std::vector<int> first_;     ///< (points) index of a point's first unknown among all
  Values values_, left_;
  Scalars inverse_diagonal_;                ///< (own unknowns of all fronts)
  Scalars unknowns_, local_;                ///< of one right-hand side: in the order of elimination; of a front
  Scalars unknowns_of_all_, local_of_all_;  ///< of `together` sides, side by side; allocated at first use
};

}  // namespace softffd
