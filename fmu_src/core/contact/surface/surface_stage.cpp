#include "contact/surface/surface_stage.hpp"

#include <algorithm>

#include "contact/surface/surface_loops.hpp"
#include "model/plane.hpp"

namespace softffd {

void SurfaceStage::set_planes(const std::vector<Vec3>& normals, const std::vector<double>& friction, const std::vector<int>& samples) {
  if (normals.size() != normals_.size()) set_.delassus().set_rows({});  // their planes may not be there
  heights.resize(normals.size());
  const int points = set_.delassus().samples().lattice().points();
  for (std::size_t q = 0; q < normals.size(); ++q) {
    heights[q].sample = samples[q];
    if (heights[q].of_points.size() == 0 && samples[q] < 0) heights[q].of_points.setZero(points);
  }
  normals_ = normals;
  friction_ = friction;
  set_.delassus().set_normals(normals_);
}

StepStatus SurfaceStage::solve(double tolerance, const std::function<Vec3(const SurfaceRow&)>& slip) {
  begin_ = heights;
  missed_ = 0;
  set_.delassus().set_rows(rows);
  if (const StepStatus status = set_.solve(candidates, heights, tolerance); status != StepStatus::ok) return status;
  before_.swap(share);
  share.assign(set_.active().size(), Vec3::Zero());
  for (std::size_t t = 0, u = 0; t < share.size(); ++t) {
    while (u < rows.size() && rows[u] < set_.active()[t]) ++u;
    if (u < rows.size() && rows[u] == set_.active()[t]) share[t] = before_[u];
  }
  rows = set_.active();
  p_.assign(rows.size(), Vec3::Zero());
  if (rubs()) {
    slip_of_ = &slip;
    if (parallel())
      missed_ = rub(true);
    else if (const StepStatus status = take_turns(tolerance); status != StepStatus::ok)
      return status;
    for (std::size_t t = 0; t < rows.size(); ++t) {
      const double limit = friction_[rows[t].plane] * set_.forces()[t];
      share[t] = limit > 0 ? Vec3(p_[t] / limit) : Vec3::Zero();
    }
  }
  find_forces();
  find_move();
  return StepStatus::ok;
}

bool SurfaceStage::hold(const std::vector<Vec3>& away) {
  const int plane = rows[0].plane, n = int(rows.size());
  const Vec3& normal = normals_[plane];
  const double friction = friction_[plane];
  Delassus& delassus = set_.delassus();
  constexpr int columns = Delassus::together;  // three are used
  missed_ = 0;
  delassus.set_rows(rows);
  columns_.resize(columns * n);
  for (int t = 0; t < n; ++t) {
    double* to = &columns_[columns * t];
    for (int a = 0; a < 3; ++a) to[a] = -away[t][a];
    to[3] = 0;
  }
  delassus.solve_together(columns_.data());
  force_.resize(n);
  share.resize(n);
  for (int t = 0; t < n; ++t) {
    const double* from = &columns_[columns * t];
    force_[t] = Vec3(from[0], from[1], from[2]);
    const double load = normal.dot(force_[t]), limit = friction * load;
    const Vec3 rubbed = tangential(normal, force_[t]);
    if (!(load >= 0 && (friction == 0 || rubbed.squaredNorm() <= limit * limit))) return false;
    share[t] = limit > 0 ? Vec3(1 / limit * rubbed) : Vec3(Vec3::Zero());
  }
  find_move();
  raise(move_);
  return true;
}

bool SurfaceStage::rubs() const {
  return std::any_of(rows.begin(), rows.end(), [&](const SurfaceRow& row) { return friction_[row.plane] > 0; });
}

/// Can friction bring no sample nearer to a plane?
bool SurfaceStage::parallel() const {
  const auto same = [&](int p, int q) { return std::abs(set_.delassus().cosine(p, q)) == 1; };
  return std::all_of(candidates.begin(), candidates.end(),
                     [&](const Candidate& candidate) { return same(rows[0].plane, candidate.row.plane); });
}

/// Friction at the normal forces at hand. Returns by what share of the slip its law is missed.
double SurfaceStage::rub(bool parallel) {
  limits_.clear();
  slips_.clear();
  for (std::size_t t = 0; t < rows.size(); ++t) {
    const int plane = rows[t].plane;
    limits_.push_back(friction_[plane] * set_.forces()[t]);
    const Vec3 slip = (*slip_of_)(rows[t]);
    slips_.push_back(tangential(normals_[plane], parallel ? slip : Vec3(slip + moved_by_normals(int(t)))));
    p_[t] = limits_[t] * share[t];
  }
  return disks_.solve({set_.delassus(), normals_, parallel, limits_, slips_}, p_);
}

Vec3 SurfaceStage::moved_by_normals(int t) const {
  Vec3 moved = Vec3::Zero();
  for (std::size_t u = 0; u < rows.size(); ++u) moved += set_.delassus()(t, int(u)) * set_.forces()[u] * normals_[rows[u].plane];
  return moved;
}

void SurfaceStage::find_forces() {
  force_.resize(rows.size());
  for (std::size_t t = 0; t < rows.size(); ++t) force_[t] = set_.forces()[t] * normals_[rows[t].plane] + p_[t];
}

void SurfaceStage::find_move() { set_.delassus().push(force_, move_); }

/// The heights by this motion.
void SurfaceStage::raise(const Points& move) {
  for (std::size_t q = 0; q < heights.size(); ++q) heights[q].raise(set_.delassus().samples(), range(), move, normals_[q]);
}

}  // namespace softffd
