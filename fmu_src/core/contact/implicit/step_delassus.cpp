#include "contact/implicit/step_delassus.hpp"

#include <algorithm>

namespace softffd {

namespace {

/// Operations to look up an element by its samples.
constexpr double element_work = 50;
/// Largest number of responses that are kept from step to step. Each has nine numbers per point, so this bounds their memory.
constexpr std::size_t most_kept = 256;

}  // namespace

void StepDelassus::set_planes(const std::vector<Vec3>& normals) {
  normals_ = normals;
  rows_.clear();
  factor(0);
}

void StepDelassus::set_matrix(StepMatrix& matrix, const Body& body) {
  matrix_ = &matrix;
  body_ = &body;
  forget_responses();
  expected_.clear();
  rows_.clear();
  factor(0);
}

void StepDelassus::forget_responses() {
  for (const auto& response : responses_) index_[response->sample] = -1;
  responses_.clear();
}

void StepDelassus::forget_many() {
  if (responses_.size() > most_kept) forget_responses();
}

void StepDelassus::set_rows(const std::vector<SurfaceRow>& rows) {
  if (rows == rows_) return;
  rows_ = rows;
  factor(0);
}

void StepDelassus::factor(int from) {
  operations_.spend(0.5 * double(size()) * (size() - from) * (size() + 2 * element_work));
  factor_.factor(
      size(), from, [&](int i, int j) { return element(rows_[i], rows_[j]); }, [&](int i) { return element(rows_[i], rows_[i]); });
}

Eigen::Matrix3d StepDelassus::block(const SurfaceRow& a, const SurfaceRow& b) {
  Eigen::Matrix3d sum = (*this)(a.sample, b.sample);
  if (free_) {
    const Handles of_a = free_->handles(a);  // a copy: the handles are valid until the next call
    sum += free_->between(of_a, free_->handles(b));
    if (a == b && !samples_->of_object(a.sample)) sum += FreeRows::give(sum) * across(normals_[a.plane]);
  }
  return sum;
}

/// Returns n_a . G n_b of two rows. Without free obstacles it uses the stored blocks.
double StepDelassus::element(const SurfaceRow& a, const SurfaceRow& b) {
  const Vec3 &along_a = normals_[a.plane], &along_b = normals_[b.plane];
  if (free_) return along_a.dot(block(a, b) * along_b);
  response(a.sample);
  response(b.sample);
  const int i = index_[a.sample], j = index_[b.sample];
  if (i < j) return along_a.dot(responses_[j]->compliance[i] * along_b);
  return along_a.dot(responses_[i]->compliance[j].transpose() * along_b);
}

double StepDelassus::give(const SurfaceRow& row) {
  const Handles handles = free_->handles(row);
  return FreeRows::give(free_->between(handles, handles));
}

Eigen::Matrix3d StepDelassus::operator()(int s, int t) {
  response(s);
  response(t);
  return compliance(index_[s], index_[t]);
}

Eigen::Matrix3d StepDelassus::compliance(int i, int j) const {
  return i < j ? Eigen::Matrix3d(responses_[j]->compliance[i]) : Eigen::Matrix3d(responses_[i]->compliance[j].transpose());
}

const StepDelassus::Response& StepDelassus::response(int s) {
  if (index_[s] >= 0) return *responses_[index_[s]];
  std::vector<int> together{s};
  const std::size_t room = std::max(1, matrix_->sides_at_once() / 3);
  for (std::size_t i = 0; i < expected_.size() && together.size() < room; ++i)
    if (index_[expected_[i]] < 0 && expected_[i] != s) together.push_back(expected_[i]);
  respond(together);
  return *responses_[index_[s]];
}

void StepDelassus::respond(const std::vector<int>& samples) {
  const std::size_t had = responses_.size();
  sides_.clear();
  for (const int s : samples) {
    if (index_[s] >= 0) continue;
    index_[s] = int(responses_.size());
    Response& made = *responses_.emplace_back(std::make_unique<Response>());
    made.sample = s;
    for (int axis = 0; axis < 3; ++axis) {
      Points& moved = made.moved[axis];
      moved.setZero(body_->points(), 3);
      if (!samples_->of_object(s)) continue;
      spread(s, Vec3::Unit(axis), moved);
      body_->hold_prescribed(moved);
      sides_.push_back(&moved);
    }
  }
  matrix_->solve_together(sides_);
  for (std::size_t r = had; r < responses_.size(); ++r) add_compliance(*responses_[r]);
}

void StepDelassus::add_compliance(Response& made) {
  operations_.spend(3 * Operations::of_place * double(index_[made.sample] + 1));
  for (int r = 0; r <= index_[made.sample]; ++r) {
    const Response& other = *responses_[r];
    const bool later = other.sample <= made.sample;  // so that bits do not depend on the order of the requests
    Eigen::Matrix3d block;
    for (int axis = 0; axis < 3; ++axis)
      block.col(axis) = later ? samples_->at(other.sample, made.moved[axis]) : samples_->at(made.sample, other.moved[axis]);
    if (!later) block.transposeInPlace();
    made.compliance.push_back(block);
  }
  Eigen::Matrix3d& own = made.compliance.back();
  own = (0.5 * (own + own.transpose())).eval();
}

void StepDelassus::add_response(int s, const Vec3& f, Points& u) {
  const Response& moved_by = response(s);
  operations_.spend(3 * double(u.size()));
  for (int axis = 0; axis < 3; ++axis)
    if (f[axis] != 0) u += f[axis] * moved_by.moved[axis];
}

void StepDelassus::spread(int s, const Vec3& f, Points& forces) const {
  weights_.resize(samples_->support());
  samples_->weights(s, Scalars::Ones(forces.rows()), weights_.data());
  for (int axis = 0; axis < 3; ++axis)
    if (f[axis] != 0) samples_->add(s, f[axis], weights_.data(), &forces(0, axis));
}

void StepDelassus::prepare(SurfaceRow row, Column& column) {
  column.row = row;
  column.own = element(row, row);
  project(column);
}

void StepDelassus::project(Column& column) {
  operations_.spend(double(size()) * (element_work + 3 * size()));
  column.half.resize(size());
  for (int t = 0; t < size(); ++t) column.half[t] = element(column.row, rows_[t]);
  factor_.project(column);
}

void StepDelassus::append(const Column& column) {
  rows_.push_back(column.row);
  factor_.append(column);
}

void StepDelassus::drop(int row, Column* column) {
  rows_.erase(rows_.begin() + row);
  factor(row);
  if (column) project(*column);
}

void StepDelassus::sort() {
  std::vector<SurfaceRow> rows = rows_;
  std::sort(rows.begin(), rows.end());
  set_rows(rows);
}

void StepDelassus::apply_impulses(const std::vector<double>& forces, const std::vector<GapFunction>& begin,
                                  std::vector<GapFunction>& gaps) {
  move_.setZero(body_->points(), 3);
  for (std::size_t t = 0; t < forces.size(); ++t) add_response(rows_[t].sample, forces[t] * normals_[rows_[t].plane], move_);
  operations_.spend(3 * double(begin.size()) * body_->points());
  gaps = begin;
  for (std::size_t q = 0; q < gaps.size(); ++q) gaps[q].add_motion(*samples_, {0, body_->points()}, move_, normals_[q]);
  if (!free_) return;
  free_->clear_twists();
  for (std::size_t t = 0; t < forces.size(); ++t) free_->add_force(rows_[t], forces[t] * normals_[rows_[t].plane]);
  for (std::size_t q = 0; q < gaps.size(); ++q)
    if (gaps[q].sample >= 0) gaps[q].of_sample += normals_[q].dot(free_->parting({int(q), gaps[q].sample}));
}

}  // namespace softffd
