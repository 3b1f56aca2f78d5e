#include "contact/delassus.hpp"

#include <algorithm>
#include <cmath>

namespace softffd {

void Delassus::set_masses(const Scalars& inverse) {
  inverse_ = inverse;
  const std::vector<SurfaceRow> rows = rows_;
  rows_.clear();
  set_rows(rows);
}

void Delassus::set_cosines(const std::vector<double>& cosines) {
  if (cosines == cosines_) return;
  cosines_ = cosines;
  planes_ = int(std::lround(std::sqrt(double(cosines.size()))));
  factor(0);
}

void Delassus::set_rows(const std::vector<SurfaceRow>& rows) {
  if (sorted_ && rows == rows_) return;
  rows_ = rows;
  const int n = size(), width = samples_->support();
  over_mass_.resize(std::size_t(n) * width);
  for (int s = 0; s < n; ++s) samples_->weights(rows_[s].sample, inverse_, &over_mass_[std::size_t(s) * width]);
  g_.resize(start(n));
  for (int s = 0; s < n; ++s)
    for (int t = 0; t <= s; ++t) g_[start(s) + t] = element(rows_[s], over_mass(s), rows_[t], over_mass(t));
  factor(0);
  sorted_ = true;
}

/// The same bits from either side.
double Delassus::element(const SurfaceRow& a, const double* of_a, const SurfaceRow& b, const double* of_b) const {
  return a.sample < b.sample ? samples_->product(a.sample, b.sample, of_b) : samples_->product(b.sample, a.sample, of_a);
}

/// The rows of L from here on.
void Delassus::factor(int from) {
  l_.resize(start(size()));
  for (int i = from; i < size(); ++i) {
    double* row = &l_[start(i)];
    double left = g_[start(i) + i];
    for (int j = 0; j < i; ++j) {
      const double* other = &l_[start(j)];
      double sum = cosine(rows_[i].plane, rows_[j].plane) * g_[start(i) + j];
      for (int m = 0; m < j; ++m) sum -= row[m] * other[m];
      row[j] = sum / other[j];
      left -= row[j] * row[j];
    }
    row[i] = std::sqrt(std::max(left, 1e-16 * g_[start(i) + i]));
  }
}

void Delassus::forward(double* b) const {
  for (int i = 0; i < size(); ++i) {
    const double* row = &l_[start(i)];
    double sum = b[i];
    for (int j = 0; j < i; ++j) sum -= row[j] * b[j];
    b[i] = sum / row[i];
  }
}

void Delassus::backward(double* b) const {
  for (int i = size() - 1; i >= 0; --i) {
    const double* row = &l_[start(i)];
    b[i] /= row[i];
    for (int j = 0; j < i; ++j) b[j] -= row[j] * b[i];
  }
}

void Delassus::solve(double* b) const {
  forward(b);
  backward(b);
}

void Delassus::prepare(SurfaceRow row, Column& column) const {
  column.row = row;
  column.over_mass.resize(samples_->support());
  samples_->weights(row.sample, inverse_, column.over_mass.data());
  column.own = samples_->product(row.sample, row.sample, column.over_mass.data());
  column.g.resize(size());
  for (int t = 0; t < size(); ++t) column.g[t] = element(row, column.over_mass.data(), rows_[t], over_mass(t));
  project(column);
}

void Delassus::project(Column& column) const {
  column.half.resize(size());
  for (int t = 0; t < size(); ++t) column.half[t] = cosine(column.row.plane, rows_[t].plane) * column.g[t];
  forward(column.half.data());
  column.left = column.own;
  for (const double each : column.half) column.left -= each * each;
  column.response = column.half;
  backward(column.response.data());
}

void Delassus::append(const Column& column) {
  rows_.push_back(column.row);
  over_mass_.insert(over_mass_.end(), column.over_mass.begin(), column.over_mass.end());
  g_.insert(g_.end(), column.g.begin(), column.g.end());
  g_.push_back(column.own);
  l_.insert(l_.end(), column.half.begin(), column.half.end());
  l_.push_back(std::sqrt(column.left));
  sorted_ = false;
}

void Delassus::drop(int row, Column* column) {
  const int width = samples_->support();
  for (int i = row + 1, at = int(start(row)); i < size(); ++i)
    for (int j = 0; j <= i; ++j)
      if (j != row) g_[at++] = g_[start(i) + j];
  over_mass_.erase(over_mass_.begin() + std::size_t(row) * width, over_mass_.begin() + std::size_t(row + 1) * width);
  rows_.erase(rows_.begin() + row);
  g_.resize(start(size()));
  factor(row);
  if (!column) return;
  column->g.erase(column->g.begin() + row);
  project(*column);
}

void Delassus::sort() {
  std::vector<SurfaceRow> rows = rows_;
  std::sort(rows.begin(), rows.end());
  if (!sorted_) set_rows(rows);
}

}  // namespace softffd
