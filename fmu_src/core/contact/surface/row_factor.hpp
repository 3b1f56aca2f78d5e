/// The Cholesky factor L L' = A of a matrix to which rows are appended, and from which they are dropped, one at a time.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

namespace softffd {

class RowFactor {
 public:
  int size() const { return size_; }
  /// Returns where row i begins in a lower triangle that is stored row by row.
  static std::size_t start(int i) { return std::size_t(i) * (i + 1) / 2; }

  /// Factors the rows from `from` on of a (size, size) matrix with elements a(i, j), i > j, and diagonal own(i), the scale of rounding.
  template <class Element, class Own>
  void factor(int size, int from, Element a, Own own) {
    size_ = size;
    l_.resize(start(size));
    inverse_.resize(size);
    for (int i = from; i < size; ++i) {
      double* row = &l_[start(i)];
      double left = own(i);
      for (int j = 0; j < i; ++j) {
        const double* other = &l_[start(j)];
        double sum = a(i, j);
        for (int m = 0; m < j; ++m) sum -= row[m] * other[m];
        row[j] = sum * inverse_[j];
        left -= row[j] * row[j];
      }
      row[i] = std::sqrt(std::max(left, least * own(i)));
      inverse_[i] = 1 / row[i];
    }
  }
  /// A row that may be appended. a: its elements with the current rows.
  struct Column {
    std::vector<double> half, response;  ///< L^-1 a and A^-1 a
    double own = 0, left = 0;            ///< its diagonal element; own less |L^-1 a|^2
  };
  /// Computes the rest of a column that has a in `half`, and its diagonal element in `own`.
  void project(Column& column) const {
    forward(column.half.data());
    column.left = column.own;
    for (const double each : column.half) column.left -= each * each;
    column.response = column.half;
    backward(column.response.data());
  }
  /// Appends a column whose `left` is > 0.
  void append(const Column& column) {
    l_.insert(l_.end(), column.half.begin(), column.half.end());
    l_.push_back(std::sqrt(column.left));
    inverse_.push_back(1 / l_.back());
    ++size_;
  }
  /// b <- L^-1 b, b <- L'^-1 b.
  void forward(double* b) const {
    for (int i = 0; i < size_; ++i) {
      const double* row = &l_[start(i)];
      for (int j = 0; j < i; ++j) b[i] -= row[j] * b[j];
      b[i] *= inverse_[i];
    }
  }
  void backward(double* b) const {
    for (int i = size_ - 1; i >= 0; --i) {
      const double* row = &l_[start(i)];
      b[i] *= inverse_[i];
      for (int j = 0; j < i; ++j) b[j] -= row[j] * b[i];
    }
  }
  void solve(double* b) const {
    forward(b);
    backward(b);
  }
  /// Solves for `together` columns at once, b (size, together) row by row.
  static constexpr int together = 4;
  void solve_together(double* b) const;

 private:
  /// Smallest L_ii^2 as a fraction of the diagonal element: rounding may leave no more than this.
  static constexpr double least = 1e-16;

  int size_ = 0;
  std::vector<double> l_, inverse_;  ///< L row by row; 1 / L_ii
};

}  // namespace softffd
