#include "contact/surface/delassus.hpp"

#include <algorithm>
#include <cmath>

#include "contact/surface/surface_loops.hpp"
#include "forces/kernels.hpp"

namespace softffd {

namespace {

/// Cosines above `aligned` or below -aligned count as those of parallel planes. A table of cosines is kept for up to `few` planes.
constexpr double aligned = 1 - 1e-15;
constexpr int few = 64;
/// Operations for the weights of a row, and for each element in a triangular solution, where every result waits for the one before it.
constexpr double weights_work = 256, solution_work = 3;

}  // namespace

bool GapFunction::find(const Samples& samples, const Points& x, const Vec3& normal, double offset) {
  if (sample < 0) return kernels::gaps(int(x.rows()), x.data(), normal.data(), offset, of_points.data()) || samples.of_nodes();
  of_sample = normal.dot(samples.at(sample, x)) - offset;
  return of_sample < 0;
}

void GapFunction::add_motion(const Samples& samples, PointRange range, const Points& move, const Vec3& normal) {
  if (sample >= 0)
    of_sample += normal.dot(samples.at(sample, move));
  else
    kernels::add_motion(int(move.rows()), range, normal.data(), move.data(), of_points.data());
}

double Delassus::between(int p, int q) const {
  const double cosine = p == q ? 1 : normals_[p].dot(normals_[q]);
  return cosine > aligned ? 1 : cosine < -aligned ? -1 : cosine;
}

void Delassus::set_normals(const std::vector<Vec3>& normals) {
  if (normals == normals_) return;
  normals_ = normals;
  before_.sorted = false;
  if (free_ || !counted_) forget();  // handles belong to the old places; rows not yet counted would be factored here
  cosines_.clear();
  const int n = int(normals.size());
  std::vector<double> table;
  for (int p = 0; p < n && n <= few; ++p)
    for (int q = 0; q < n; ++q) table.push_back(between(p, q));
  cosines_.swap(table);
  factor(0);
}

void Delassus::set_masses(const Scalars& inverse) {
  inverse_ = inverse;
  forget();
}

void Delassus::forget() {
  for (auto* rows : {&rows_, &before_.rows}) rows->clear();
  for (auto* numbers : {&over_mass_, &g_, &before_.over_mass, &before_.g}) numbers->clear();
  handles_.clear();
  of_masses_.clear();
  range_ = {int(inverse_.size()), 0};
  sorted_ = true;
  before_.sorted = false;
  factor(0);
}

void Delassus::begin() {
  counted_ = false;
  of_masses_.clear();
}

/// Rows kept from before count as if they were made now: the work that contact may do must not depend on them.
void Delassus::set_rows(const std::vector<SurfaceRow>& rows) {
  const auto at_hand = [&] { return sorted_ && rows == rows_ && !free_; };
  if (at_hand() && counted_) return;
  if (!at_hand()) exchange();
  if (at_hand()) {
    counted_ = true;
    return operations_.spend(work_of_rows() + work_of_factor(0));
  }
  list_rows(rows);
  factor(0);
}

double Delassus::work_of_rows() const { return size() * (weights_work + 0.5 * size() * samples_->support()); }
double Delassus::work_of_factor(int from) const { return 0.5 * double(size()) * size() * (size() - from); }

/// Swaps the current rows with the rows before them.
void Delassus::exchange() {
  if (free_) return;
  rows_.swap(before_.rows);
  over_mass_.swap(before_.over_mass);
  g_.swap(before_.g);
  std::swap(factor_, before_.factor);
  std::swap(range_, before_.range);
  std::swap(sorted_, before_.sorted);
}

/// With free bodies, G is kept if the samples are the same.
void Delassus::list_rows(const std::vector<SurfaceRow>& rows) {
  const bool same =
      free_ && sorted_ && counted_ && !rows.empty() && std::ranges::equal(rows, rows_, {}, &SurfaceRow::sample, &SurfaceRow::sample);
  rows_ = rows;
  handles_.clear();
  for (std::size_t s = 0; s < rows.size() && free_; ++s) handles_.push_back(free_->handles(rows[s]));
  sorted_ = counted_ = true;
  if (same) return;
  const int n = size(), width = samples_->support();
  operations_.spend(work_of_rows());
  over_mass_.resize(std::size_t(n) * width);
  for (int s = 0; s < n; ++s) samples_->weights(rows_[s].sample, inverse_, &over_mass_[std::size_t(s) * width]);
  range_ = {int(inverse_.size()), 0};
  find_range(0);
  g_.resize(start(n));
  for (int s = 0; s < n; ++s)
    for (int t = 0; t <= s; ++t) g_[start(s) + t] = element(rows_[s], over_mass(s), rows_[t], over_mass(t));
}

/// Extends the range by the points of the rows from `from` on. The points of a dropped row stay in it: they cost time and change nothing.
void Delassus::find_range(int from) {
  const int points = int(inverse_.size());
  const PointRange more = samples_->support() == points
                              ? Samples::range(over_mass_.data() + std::size_t(from) * points, size() - from, points)
                              : PointRange{0, points};
  range_ = {std::min(range_.begin, more.begin), std::max(range_.end, more.end)};
}

/// Returns an element of G, with the same bits if a and b are exchanged.
double Delassus::element(const SurfaceRow& a, const double* of_a, const SurfaceRow& b, const double* of_b) const {
  return a.sample < b.sample ? samples_->product(a.sample, b.sample, of_b) : samples_->product(b.sample, a.sample, of_a);
}

/// Computes the rows of L from `from` on.
void Delassus::factor(int from) {
  operations_.spend(work_of_factor(from));
  if (free_) {
    const auto a = [&](int i, int j) {
      return cosine(rows_[i].plane, rows_[j].plane) * g_[start(i) + j] + yield(rows_[i], handles_[i], rows_[j], handles_[j]);
    };
    return factor_.factor(size(), from, a, [&](int i) { return a(i, i); });
  }
  factor_.factor(
      size(), from, [&](int i, int j) { return cosine(rows_[i].plane, rows_[j].plane) * g_[start(i) + j]; },
      [&](int i) { return g_[start(i) + i]; });
}

Eigen::Matrix3d Delassus::block(int s, int t) const {
  Eigen::Matrix3d sum = (*this)(s, t) * Eigen::Matrix3d::Identity();
  if (free_) sum += free_->between(handles_[s], handles_[t]);
  if (s == t && !samples_->of_object(rows_[s].sample)) sum += FreeRows::give(sum) * across(normals_[rows_[s].plane]);
  return sum;
}

void Delassus::stick(const std::vector<Vec3>& away, std::vector<Vec3>& forces) {
  const int n = size();
  bool known = int(of_masses_.size()) == n;
  for (int s = 0; s < n && known; ++s) known = of_masses_[s] == rows_[s].sample;
  if (!known) {
    of_masses_.clear();
    for (const SurfaceRow& row : rows_) of_masses_.push_back(row.sample);
    operations_.spend(n * (1.0 * n) * n / 6);
    masses_.factor(n, 0, [&](int i, int j) { return g_[start(i) + j]; }, [&](int i) { return g_[start(i) + i]; });
  }
  operations_.spend(14.0 * n * n + 500.0 * n);
  free_->stick(handles_, away, [&](double* columns) { masses_.solve_together(columns); }, forces);
}

void Delassus::move_gaps(const Points& move, std::vector<GapFunction>& gaps) const {
  operations_.spend(4 * double(gaps.size()) * double(move.rows()));
  for (std::size_t q = 0; q < gaps.size(); ++q) {
    gaps[q].add_motion(*samples_, range(), move, normals_[q]);
    if (free_ && gaps[q].sample >= 0) gaps[q].of_sample += normals_[q].dot(free_->parting({int(q), gaps[q].sample}));
  }
}

/// If all rows are on one plane, they move the points along its normal only.
void Delassus::apply_impulses(const std::vector<double>& forces, const std::vector<GapFunction>& begin, std::vector<GapFunction>& gaps) {
  gaps = begin;
  if (rows_.empty()) return;
  const int one = rows_[0].plane, points = int(inverse_.size());
  operations_.spend(double(begin.size() + rows_.size()) * points);
  if (!free_ && std::ranges::all_of(rows_, [&](const SurfaceRow& row) { return row.plane == one; })) {
    field_.setZero(points);
    for (std::size_t t = 0; t < forces.size(); ++t) push(int(t), forces[t], field_.data());
    for (std::size_t q = 0; q < gaps.size(); ++q) {
      const double along = cosine(int(q), one);
      if (along == 0) continue;
      if (gaps[q].sample >= 0)
        gaps[q].of_sample += along * samples_->at(gaps[q].sample, field_.data());
      else
        gaps[q].of_points += along * field_;
    }
    return;
  }
  pushes_.clear();
  for (std::size_t t = 0; t < forces.size(); ++t) pushes_.push_back(forces[t] * normals_[rows_[t].plane]);
  push(pushes_, move_);
  move_gaps(move_, gaps);
}

void Delassus::push(const std::vector<Vec3>& forces, Points& move) const {
  const int points = int(inverse_.size());
  operations_.spend(3.0 * size() * samples_->support());
  move.resize(points, 3);
  const bool dense = size() > 0 && samples_->support() == points;  // each row has the weights of all points, in their order
  if (!dense || range_ != PointRange{0, points}) move.setZero();
  if (dense)
    kernels::weighted_sums(points, range_, size(), forces.front().data(), over_mass_.data(), move.data());
  else
    for (int t = 0; t < size(); ++t) samples_->add(rows_[t].sample, forces[t], over_mass(t), move);
  if (!free_) return;
  free_->find_twists(handles_, forces);
  free_->move_pins(move);
}

void Delassus::prepare(SurfaceRow row, Column& column) const {
  column.row = row;
  operations_.spend(weights_work + double(size()) * samples_->support());
  column.over_mass.resize(samples_->support());
  samples_->weights(row.sample, inverse_, column.over_mass.data());
  column.own = column.diagonal = samples_->product(row.sample, row.sample, column.over_mass.data());
  if (free_) {
    column.handles = free_->handles(row);
    column.own += yield(row, column.handles, row, column.handles);
  }
  column.g.resize(size());
  for (int t = 0; t < size(); ++t) column.g[t] = element(row, column.over_mass.data(), rows_[t], over_mass(t));
  project(column);
}

void Delassus::project(Column& column) const {
  operations_.spend(solution_work * size() * size());
  column.half.resize(size());
  for (int t = 0; t < size(); ++t) {
    column.half[t] = cosine(column.row.plane, rows_[t].plane) * column.g[t];
    if (free_) column.half[t] += yield(column.row, column.handles, rows_[t], handles_[t]);
  }
  factor_.project(column);
}

void Delassus::append(const Column& column) {
  rows_.push_back(column.row);
  over_mass_.insert(over_mass_.end(), column.over_mass.begin(), column.over_mass.end());
  g_.insert(g_.end(), column.g.begin(), column.g.end());
  g_.push_back(column.diagonal);
  if (free_) handles_.push_back(column.handles);
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
  if (free_) handles_.erase(handles_.begin() + row);
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
