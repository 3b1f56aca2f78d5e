/// The generalised minimal residual method (Saad & Schultz 1986) for small nonsymmetric systems whose matrix is known only by its product
/// with a vector.
#pragma once
#include <array>
#include <cmath>

#include "model/types.hpp"

namespace softffd {

class Gmres {
 public:
  static constexpr int most = 8;  ///< largest number of products with the matrix

  explicit Gmres(int unknowns) : y_(unknowns) {
    for (Scalars& v : basis_) v.resize(unknowns);
  }

  /// Returns y with |A y - b| <= reduction |b|, or the best y after `most` products; apply(v, Av) computes A v. Only the first n entries
  /// of vectors count.
  template <class Apply>
  const Scalars& solve(int n, const Scalars& b, double reduction, Apply apply) {
    const double size = norm(n, b);
    y_.setZero();
    if (size == 0) return y_;
    right_ = {};
    right_[0] = size;
    for (int i = 0; i < n; ++i) basis_[0][i] = b[i] / size;
    int used = 0;
    while (used < most && used < n && std::abs(right_[used]) > reduction * size) {
      const int j = used;
      apply(basis_[j], basis_[j + 1]);
      if (!orthogonalise(n, j)) break;
      ++used;
    }
    combine(n, used);
    return y_;
  }

 private:
  static double dot(int n, const Scalars& a, const Scalars& b) {
    double sum = 0;
    for (int i = 0; i < n; ++i) sum += a[i] * b[i];
    return sum;
  }
  static double norm(int n, const Scalars& a) { return std::sqrt(dot(n, a, a)); }
  static void turn(double cosine, double sine, double& a, double& b) {
    const double first = cosine * a + sine * b;
    b = cosine * b - sine * a;
    a = first;
  }

  /// Makes the last product orthogonal to the basis and its column triangular. Returns false if the new diagonal entry is zero.
  bool orthogonalise(int n, int j) {
    Scalars& next = basis_[j + 1];
    auto& column = columns_[j];
    for (int i = 0; i <= j; ++i) {
      column[i] = dot(n, basis_[i], next);
      for (int m = 0; m < n; ++m) next[m] -= column[i] * basis_[i][m];
    }
    column[j + 1] = norm(n, next);
    if (column[j + 1] > 0)
      for (int m = 0; m < n; ++m) next[m] /= column[j + 1];
    for (int i = 0; i < j; ++i) turn(cosine_[i], sine_[i], column[i], column[i + 1]);
    const double length = std::sqrt(column[j] * column[j] + column[j + 1] * column[j + 1]);
    if (!(length > 0)) return false;
    cosine_[j] = column[j] / length;
    sine_[j] = column[j + 1] / length;
    turn(cosine_[j], sine_[j], column[j], column[j + 1]);
    turn(cosine_[j], sine_[j], right_[j], right_[j + 1]);
    return true;
  }

  void combine(int n, int used) {
    for (int j = used - 1; j >= 0; --j) {
      double sum = right_[j];
      for (int i = j + 1; i < used; ++i) sum -= columns_[i][j] * weight_[i];
      weight_[j] = sum / columns_[j][j];
    }
    for (int j = 0; j < used; ++j)
      for (int m = 0; m < n; ++m) y_[m] += weight_[j] * basis_[j][m];
  }

  std::array<Scalars, most + 1> basis_;
  std::array<std::array<double, most + 1>, most> columns_;  ///< columns of the Hessenberg matrix, brought to triangular form
  std::array<double, most + 1> right_;
  std::array<double, most> cosine_, sine_, weight_;
  Scalars y_;
};

}  // namespace softffd
