#include "contact/surface_stage.hpp"

#include <algorithm>

#include "contact/surface_loops.hpp"
#include "model/plane.hpp"

namespace softffd {

namespace {

/// Cosines so near to 1 or -1 are those of parallel planes.
constexpr double aligned = 1 - 1e-15;

}  // namespace

SurfaceStage::SurfaceStage(const Samples& samples, int planes) : heights(planes), set_(samples) {}

void SurfaceStage::set_planes(const std::vector<Vec3>& normals, const std::vector<double>& friction) {
  if (normals.size() != normals_.size()) set_.delassus().set_rows({});  // their planes may not be there
  heights.resize(normals.size());
  normals_ = normals;
  friction_ = friction;
  cosines_.clear();
  for (std::size_t p = 0; p < normals.size(); ++p)
    for (std::size_t q = 0; q < normals.size(); ++q) {
      const double cosine = p == q ? 1 : normals[p].dot(normals[q]);
      cosines_.push_back(cosine > aligned ? 1 : cosine < -aligned ? -1 : cosine);
    }
  set_.delassus().set_cosines(cosines_);
}

StepStatus SurfaceStage::solve(double tolerance, const std::function<Vec3(const SurfaceRow&)>& slip) {
  begin_ = heights;
  missed_ = 0;
  set_.delassus().set_rows(rows);
  held_ = hold(tolerance, slip);
  if (held_) return StepStatus::ok;
  heights = begin_;
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

/// By the rows of one plane at hand, all sticking, with all candidates in front.
bool SurfaceStage::hold(double tolerance, const std::function<Vec3(const SurfaceRow&)>& slip) {
  if (rows.empty() || candidates.front().row.plane != candidates.back().row.plane) return false;
  const int plane = rows[0].plane, n = int(rows.size());
  const Vec3& normal = normals_[plane];
  const bool rough = friction_[plane] > 0;
  Delassus& delassus = set_.delassus();
  const Samples& samples = delassus.samples();
  constexpr int columns = Delassus::together;  // three are used
  hold_.assign(columns * n, 0.0);
  for (std::size_t t = 0, c = 0; t < rows.size(); ++t) {
    while (candidates[c].row < rows[t]) ++c;
    const double gap = samples.at(rows[t].sample, heights[plane].data()) - candidates[c].bound;
    const Vec3 across = rough ? tangential(normal, slip(rows[t])) : Vec3(Vec3::Zero());
    const Vec3 away = gap * normal + across;
    for (int a = 0; a < 3; ++a) hold_[columns * t + a] = -away[a];
  }
  delassus.solve_together(hold_.data());
  force_.resize(n);
  for (int t = 0; t < n; ++t) {
    force_[t] = Vec3(hold_[columns * t], hold_[columns * t + 1], hold_[columns * t + 2]);
    const double load = normal.dot(force_[t]), limit = friction_[plane] * load;
    if (!(load >= 0 && (!rough || tangential(normal, force_[t]).squaredNorm() <= limit * limit))) return false;
  }
  find_move();
  const std::ptrdiff_t points = move_.rows();
  for (int a = 0; a < 3; ++a)
    if (normal[a] != 0) kernels::add_scaled(points, normal[a], &move_(0, a), heights[plane].data());
  std::size_t active = 0;
  for (Candidate& candidate : candidates) {
    candidate.gap = samples.at(candidate.row.sample, heights[plane].data()) - candidate.bound;
    const bool here = active < rows.size() && candidate.row == rows[active];
    active += here;
    if (!(candidate.gap >= -tolerance && (!here || candidate.gap <= tolerance))) return false;
  }
  for (int t = 0; t < n; ++t) {
    const double limit = friction_[plane] * normal.dot(force_[t]);
    share[t] = limit > 0 ? Vec3(tangential(normal, force_[t]) / limit) : Vec3(Vec3::Zero());
  }
  return true;
}

bool SurfaceStage::rubs() const {
  return std::any_of(rows.begin(), rows.end(), [&](const SurfaceRow& row) { return friction_[row.plane] > 0; });
}

/// Can friction bring no sample nearer to a plane?
bool SurfaceStage::parallel() const {
  const auto same = [&](int p, int q) { return std::abs(cosines_[p * normals_.size() + q]) == 1; };
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

}  // namespace softffd
