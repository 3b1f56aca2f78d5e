#include "contact/surface/delassus.hpp"

#include <algorithm>
#include <cmath>

#include "contact/surface/surface_loops.hpp"

namespace softffd {

namespace {

/// Cosines so near to 1 or -1 are those of parallel planes; up to so many planes have a table of them.
constexpr double aligned = 1 - 1e-15;
constexpr std::size_t few = 64;

}  // namespace

double Delassus::between(const std::vector<Vec3>& normals, int p, int q) {
  const double cosine = p == q ? 1 : normals[p].dot(normals[q]);
  return cosine > aligned ? 1 : cosine < -aligned ? -1 : cosine;
}

void Delassus::set_normals(const std::vector<Vec3>& normals) {
  const int n = int(normals.size());
  if (normals.size() <= few) {
    std::vector<double> cosines;
    for (int p = 0; p < n; ++p)
      for (int q = 0; q < n; ++q) cosines.push_back(between(normals, p, q));
    normals_.clear();
    set_cosines(cosines);
  } else if (normals != normals_) {
    cosines_.clear();
    normals_ = normals;
    factor(0);
  }
}

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
  range_ = {int(inverse_.size()), 0};
  find_range(0);
  g_.resize(start(n));
  for (int s = 0; s < n; ++s)
    for (int t = 0; t <= s; ++t) g_[start(s) + t] = element(rows_[s], over_mass(s), rows_[t], over_mass(t));
  factor(0);
  sorted_ = true;
}

/// With those of the rows from here on. A row that is dropped leaves its own, which cost time and change nothing.
void Delassus::find_range(int from) {
  const int points = int(inverse_.size());
  const PointRange more = samples_->support() == points
                              ? Samples::range(over_mass_.data() + std::size_t(from) * points, size() - from, points)
                              : PointRange{0, points};
  range_ = {std::min(range_.begin, more.begin), std::max(range_.end, more.end)};
}

/// The same bits from either side.
double Delassus::element(const SurfaceRow& a, const double* of_a, const SurfaceRow& b, const double* of_b) const {
  return a.sample < b.sample ? samples_->product(a.sample, b.sample, of_b) : samples_->product(b.sample, a.sample, of_a);
}

/// The rows of L from here on.
void Delassus::factor(int from) {
  spend(0.5 * double(size()) * size() * (size() - from));
  factor_.factor(
      size(), from, [&](int i, int j) { return cosine(rows_[i].plane, rows_[j].plane) * g_[start(i) + j]; },
      [&](int i) { return g_[start(i) + i]; });
}

void Delassus::raise(const std::vector<double>& forces, const std::vector<Scalars>& begin, std::vector<Scalars>& heights) {
  fields_.resize(begin.size());
  pushed_.clear();
  for (const SurfaceRow& row : rows_) pushed_.push_back(row.plane);
  std::sort(pushed_.begin(), pushed_.end());
  pushed_.erase(std::unique(pushed_.begin(), pushed_.end()), pushed_.end());
  for (const int r : pushed_) fields_[r].setZero(begin[0].size());
  for (std::size_t t = 0; t < forces.size(); ++t) push(int(t), forces[t], fields_[rows_[t].plane].data());
  for (std::size_t q = 0; q < fields_.size(); ++q) {
    heights[q] = begin[q];
    for (const int r : pushed_)
      if (const double along = cosine(int(q), r); along != 0) heights[q] += along * fields_[r];
  }
  spend(double(begin.size()) * double(begin[0].size()) * double(1 + pushed_.size()));
}

void Delassus::push(const std::vector<Vec3>& forces, Points& move) const {
  const int points = int(inverse_.size());
  move.resize(points, 3);
  const bool dense = size() > 0 && samples_->support() == points;  // the weights of all points, in their order
  if (!dense || range_ != PointRange{0, points}) move.setZero();
  if (dense) return kernels::weighted_sums(points, range_, size(), forces.front().data(), over_mass_.data(), move.data());
  for (int t = 0; t < size(); ++t) samples_->add(rows_[t].sample, forces[t], over_mass(t), move);
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
  factor_.project(column);
}

void Delassus::append(const Column& column) {
  rows_.push_back(column.row);
  over_mass_.insert(over_mass_.end(), column.over_mass.begin(), column.over_mass.end());
  g_.insert(g_.end(), column.g.begin(), column.g.end());
  g_.push_back(column.own);
  find_range(size() - 1);
  factor_.append(column);
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
