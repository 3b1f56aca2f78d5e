#include "model/samples.hpp"

#include <algorithm>

namespace softffd {

namespace {

/// Sum of x_i y_j z_k values(i, j, k), whose lines and layers are so far apart; four control points per axis, the usual case.
double weigh_four(const double* x, const double* y, const double* z, const double* values, int line, int layer) {
  double sum[4] = {};
  for (int k = 0; k < 4; ++k)
    for (int j = 0; j < 4; ++j) {
      const double factor = z[k] * y[j], *at = values + j * line + k * layer;
      for (int i = 0; i < 4; ++i) sum[i] += factor * at[i];
    }
  return (x[0] * sum[0] + x[1] * sum[1]) + (x[2] * sum[2] + x[3] * sum[3]);
}

double weigh(const double* x, const double* y, const double* z, const std::array<int, 3>& n, const double* values, int line, int layer) {
  if (n[0] == 4 && n[1] == 4 && n[2] == 4) return weigh_four(x, y, z, values, line, layer);
  double sum = 0;
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j) {
      double along = 0;
      for (int i = 0; i < n[0]; ++i) along += x[i] * values[i + j * line + k * layer];
      sum += z[k] * y[j] * along;
    }
  return sum;
}

}  // namespace

Samples::Samples(Basis basis, const Lattice& lattice, const std::vector<Vec3>& places)
    : lattice_(lattice), counts_(lattice.counts), places_(places) {
  for (int a = 0; a < 3; ++a) width_[a] = basis == Basis::bezier ? counts_[a] : std::min(counts_[a], 4);
  for (const Vec3& place : places_) {
    std::array<int, 3> first;
    for (int a = 0; a < 3; ++a) {
      const Scalars all = softffd::weights(basis, (place[a] - lattice.origin[a]) / lattice.size[a], counts_[a]);
      first[a] = 0;
      while (all[first[a]] == 0 && first[a] + width_[a] < counts_[a]) ++first[a];
      factors_.insert(factors_.end(), all.begin() + first[a], all.begin() + first[a] + width_[a]);
    }
    first_.push_back(first);
  }
}

double Samples::at(int s, const double* values) const {
  const auto& f = first_[s];
  const double *x = factors(s), *y = x + width_[0], *z = y + width_[1];
  return weigh(x, y, z, width_, values + f[0] + counts_[0] * (f[1] + counts_[1] * f[2]), counts_[0], counts_[0] * counts_[1]);
}

void Samples::weights(int s, const Scalars& scale, double* out) const {
  const auto& f = first_[s];
  const double *x = factors(s), *y = x + width_[0], *z = y + width_[1];
  for (int k = 0; k < width_[2]; ++k)
    for (int j = 0; j < width_[1]; ++j) {
      const int begin = f[0] + counts_[0] * (f[1] + j + counts_[1] * (f[2] + k));
      const double factor = z[k] * y[j];
      for (int i = 0; i < width_[0]; ++i) *out++ = factor * x[i] * scale[begin + i];
    }
}

double Samples::product(int t, int s, const double* of_s) const {
  std::array<const double*, 3> factor{factors(t), factors(t) + width_[0], factors(t) + width_[0] + width_[1]};
  std::array<int, 3> begin, common;
  for (int a = 0; a < 3; ++a) {
    const int first = std::max(first_[t][a], first_[s][a]);
    common[a] = std::min(first_[t][a], first_[s][a]) + width_[a] - first;
    if (common[a] <= 0) return 0;
    factor[a] += first - first_[t][a];
    begin[a] = first - first_[s][a];
  }
  return weigh(factor[0], factor[1], factor[2], common, of_s + begin[0] + width_[0] * (begin[1] + width_[1] * begin[2]), width_[0],
               width_[0] * width_[1]);
}

void Samples::add(int s, double factor, const double* of_s, double* values) const {
  const auto& f = first_[s];
  if (width_[0] == 4) {  // the usual case, several at a time
    for (int k = 0; k < width_[2]; ++k)
      for (int j = 0; j < width_[1]; ++j, of_s += 4) {
        double* at = values + f[0] + counts_[0] * (f[1] + j + counts_[1] * (f[2] + k));
        for (int i = 0; i < 4; ++i) at[i] += factor * of_s[i];
      }
    return;
  }
  for (int k = 0; k < width_[2]; ++k)
    for (int j = 0; j < width_[1]; ++j) {
      double* at = values + f[0] + counts_[0] * (f[1] + j + counts_[1] * (f[2] + k));
      for (int i = 0; i < width_[0]; ++i) at[i] += factor * *of_s++;
    }
}

}  // namespace softffd
