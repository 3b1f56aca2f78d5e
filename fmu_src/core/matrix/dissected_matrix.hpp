/// Symmetric positive definite matrices of the lattice and their Cholesky factor, front by front (dissection.hpp): the multifrontal method
/// (Duff & Reid 1983).
///
/// A front has three unknowns a row. The columns of its own rows are stored, and in them all rows of the front: what the matrix has there,
/// and in the end the factor. What a front then leaves for its boundary, a dense lower triangle, is added to the columns of its parent and
/// to what that leaves:
///
///          own        boundary
///        [ L         ]               own rows and boundary rows are padded to a multiple of eight, own ones with ones on the diagonal
///        [ L     left ]              left -= L L^T, then it is the parent's
///
/// Of n x n x n points a factor takes 80 to 110 n^6 multiplications, where layer after layer it would be 30 n^7 (springs) and 280 n^7
/// (solids, three planes at a time), and 80 to 90 n^4 numbers. The loops are panels.hpp's: same bits on every instruction set.
#pragma once
#include <memory>
#include <span>
#include <vector>

#include "forces/blocks.hpp"
#include "matrix/dissection.hpp"

namespace softffd {

class DissectedMatrix {
 public:
  /// Memory is taken here and first touched by `clear`.
  explicit DissectedMatrix(const Lattice& lattice);

  void clear();
  /// Of two points that meet, or of one. One triangle alone is stored: the block of (p, q) is that of (q, p), turned over.
  Mat3 block(int p, int q) const;
  /// Of two points; or of one, then symmetric.
  void set_block(int p, int q, const Mat3& block) {
    visit(p, q, [&](int a, int b, double& entry) { entry = block(a, b); });
  }
  void add_block(int p, int q, const Mat3& block) {
    visit(p, q, [&](int a, int b, double& entry) { entry += block(a, b); });
  }

  /// Cholesky factor in place. Of a matrix that is not positive definite to rounding it has NaN in it.
  void factor();
  /// b <- A^-1 b, (points, 3), with the factor.
  void solve(Points& b);
  /// The same for up to `together` right sides, whose bits do not depend on which ones come together. Fronts that none of them acts on are
  /// passed over on the way up.
  static constexpr std::size_t together = 8;
  void solve_together(std::span<Points* const> sides);

 private:
  struct Free {
    void operator()(double* values) const;
  };
  using Values = std::unique_ptr<double[], Free>;
  /// Where a front's numbers are.
  struct Block {
    int own, rows;        ///< unknowns with padding
    std::size_t stride;   ///< between columns
    std::size_t columns;  ///< in values_
    std::size_t left;     ///< in left_; its columns are rows - own apart
    int first;            ///< of its own unknowns among all
  };
  static Values taken(std::size_t count);
  /// First unknown of a row.
  static int unknown(const Dissection::Front& front, const Block& block, int row) {
    return row < front.own ? 3 * row : block.own + 3 * (row - front.own);
  }
  /// Of two points, or of one: where its rows begin in the columns of the point that leaves first.
  double* entries(int of_columns, int of_rows) const {
    const int f = order_.front(of_columns);
    const Dissection::Front& front = order_.fronts()[f];
    const Block& block = blocks_[f];
    const int row = order_.front(of_rows) == f ? order_.row(of_rows) : order_.row(front, of_rows);
    return values_.get() + block.columns + 3 * order_.row(of_columns) * block.stride + unknown(front, block, row);
  }
  /// All nine entries of a block; of one point both halves, of which the lower one has a meaning.
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
  std::vector<int> first_;     ///< (points) of a point's unknowns among all
  Values values_, left_;
  Scalars inverse_diagonal_;                ///< (own unknowns of all fronts)
  Scalars unknowns_, local_;                ///< of one right side: in the order of leaving; of a front
  Scalars unknowns_of_all_, local_of_all_;  ///< of `together`, side by side, from the first time on that they are wanted
};

}  // namespace softffd
