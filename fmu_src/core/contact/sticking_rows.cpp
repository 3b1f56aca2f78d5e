#include "contact/sticking_rows.hpp"

namespace softffd {

void StickingRows<double>::resize(int sticking, int rows) {
  sticking_ = sticking;
  rows_ = rows;
  g_.resize(std::size_t(rows) * rows);
}

void StickingRows<double>::eliminate(std::vector<Vec3>& right) {
  for (int i = 0; i < sticking_; ++i) {
    double* row = &g_[i * rows_];
    row[i] = 1 / row[i];
    for (int r = i + 1; r < rows_; ++r) {
      const double factor = row[i] * row[r];
      double* other = &g_[r * rows_];
      for (int j = r; j < rows_; ++j) other[j] -= factor * row[j];
      right[r] -= factor * right[i];
    }
  }
}

void StickingRows<double>::substitute(std::vector<Vec3>& right) const {
  for (int i = sticking_ - 1; i >= 0; --i) {
    const double* row = &g_[i * rows_];
    for (int j = i + 1; j < rows_; ++j) right[i] -= row[j] * right[j];
    right[i] *= row[i];
  }
}

void StickingRows<Eigen::Matrix3d>::set(int i, int j, const Eigen::Matrix3d& block) {
  for (int b = 0; b < 3; ++b)
    for (int a = i == j ? b : 0; a < 3; ++a) factor_(3 * i + a, 3 * j + b) = block(b, a);
}

void StickingRows<Eigen::Matrix3d>::add_to_diagonal(int i, double own) {
  for (int a = 0; a < 3; ++a) factor_(3 * i + a, 3 * i + a) += own;
}

void StickingRows<Eigen::Matrix3d>::put(const std::vector<Vec3>& right) {
  for (std::size_t i = 0; i < right.size(); ++i)
    for (int a = 0; a < 3; ++a) factor_.right(3 * int(i) + a) = right[i][a];
}

void StickingRows<Eigen::Matrix3d>::take(std::vector<Vec3>& right) {
  for (std::size_t i = 0; i < right.size(); ++i)
    for (int a = 0; a < 3; ++a) right[i][a] = factor_.right(3 * int(i) + a);
}

void StickingRows<Eigen::Matrix3d>::eliminate(std::vector<Vec3>& right) {
  factor_.factor();
  put(right);
  factor_.eliminate();
  take(right);
}

Eigen::Matrix3d StickingRows<Eigen::Matrix3d>::left(int i, int j) {
  Eigen::Matrix3d block;
  for (int b = 0; b < 3; ++b)
    for (int a = 0; a < 3; ++a) block(a, b) = i == j && a < b ? factor_(3 * i + b, 3 * j + a) : factor_(3 * i + a, 3 * j + b);
  return block;
}

void StickingRows<Eigen::Matrix3d>::substitute(std::vector<Vec3>& right) {
  put(right);
  factor_.substitute();
  take(right);
}

}  // namespace softffd
