/// Between steps: samples that planes have jumped over, and those that touch.
#include <algorithm>

#include "contact/surface_contact.hpp"
#include "contact/tolerances.hpp"

namespace softffd {

namespace {

/// Moves out of solids that one after the other may need.
constexpr int most_looks = 50;

}  // namespace

StepStatus SurfaceContact::clear_jumps(const Body& body, const Drive& around, double time, Points& x, bool& moved) {
  const auto clear = [&] {
    double deepest = 0;
    return !gaps_at(around, time, x, deepest) || deepest >= -position_slack * (length_ + row(x, 0).norm());
  };
  know(around);
  if (clear()) return StepStatus::ok;
  if (body.version != version_) {
    version_ = body.version;
    h_ = -1;
    drift_.set_masses(body.inverse_mass.head(body.points()));
  }
  const bool free = std::none_of(body.pinned.begin(), body.pinned.end(), [](bool pinned) { return pinned; });
  for (int looks = 0; looks < most_looks; ++looks) {
    if (free) shift(x);
    for (std::size_t q = 0; q < end_.size(); ++q)
      kernels::gaps(body.points(), x.data(), end_[q].normal.data(), end_[q].offset, drift_.heights[q].data());
    const std::vector<Count> none;
    const StepStatus status = fit(none, move_, 0, [](const SurfaceRow&) { return Vec3(Vec3::Zero()); });
    if (status != StepStatus::ok) return status;
    drift_.add_move(x);
    moved = true;
    if (!solids_ || clear()) return StepStatus::ok;  // before solids other samples may have come
  }
  return StepStatus::impossible_planes;
}

/// Solids, which come after the planes, have rows by their tangents alone.
void SurfaceContact::know(const Drive& around) {
  solids_ = around.planes.back().solid();
  if (!solids_) return;
  touching_.clear();
  lasting_.clear();
  flat_ = int(std::count_if(around.planes.begin(), around.planes.end(), [](const Plane& plane) { return !plane.solid(); }));
  resize(flat_);
}

void SurfaceContact::resize(std::size_t planes) {
  for (auto* each : {&start_, &middle_, &end_}) each->resize(planes);
  friction_.resize(planes);
  normals_.resize(planes);
  obstacle_.resize(planes);
}

/// The tangents of what can come to a solid from t0 to t1, if no point moves further than this [m].
void SurfaceContact::find_tangents(const Drive& around, double t0, double t1, const Points& x0, double way) {
  std::vector<std::pair<Count, Candidate>> lasting;
  for (const Candidate& candidate : lasting_) lasting.push_back({number(candidate.row), candidate});
  tangents_.find(around, t0, t1, x0, way);
  resize(flat_ + tangents_.found().size());
  int q = flat_;
  for (const Tangent& each : tangents_.found()) {
    start_[q] = each.start;
    middle_[q] = each.middle;
    end_[q] = each.end;
    friction_[q] = around.planes[each.obstacle].friction;
    obstacle_[q++] = each.obstacle;
  }
  set_planes();
  for (SurfaceStage* stage : {&drift_, &close_})
    for (Scalars& heights : stage->heights) heights.resize(x0.rows());
  lasting_.clear();
  for (auto& [known, candidate] : lasting) {
    if (candidate.row.plane >= flat_) {
      const auto at = std::ranges::find(tangents_.found(), known,
                                        [&](const Tangent& each) { return Count(each.obstacle) * samples_.count() + each.sample; });
      if (at == tangents_.found().end()) continue;
      candidate.row.plane = flat_ + int(at - tangents_.found().begin());
    }
    lasting_.push_back(candidate);
  }
}

void SurfaceContact::look(const Drive& around, double time, const Points& x) {
  touching_.clear();
  for (int q = 0; q < flat_; ++q)
    for (const int s : near(q, end_[q], x))
      if (samples_.at(s, drift_.heights[q].data()) <= touching * length_) touching_.push_back({.row = {q, s}});
  if (solids_) find_tangents(around, time, time, x, 0);
  for (int q = flat_; q < int(end_.size()); ++q) touching_.push_back({.row = {q, tangents_.found()[q - flat_].sample}});
  lasting_ = touching_;
  holds_ = true;
}

/// Samples near plane q where it is now, all that touch it among them; their heights are those of drift_.
const std::vector<int>& SurfaceContact::near(int q, const HalfSpace& plane, const Points& x) {
  Scalars& heights = drift_.heights[q];
  kernels::gaps(int(x.rows()), x.data(), plane.normal.data(), plane.offset, heights.data());
  if (!search_.covers(q, heights)) search_.look(q, heights, 0);
  return search_.near(q);
}

/// Planes without friction and heights above them; deepest: of the samples [m]. Returns whether any control point is behind one.
bool SurfaceContact::gaps_at(const Drive& around, double time, const Points& x, double& deepest) {
  bool any = false;
  for (int q = 0; q < flat_; ++q) end_[q] = around.planes[q].at(time);
  if (solids_) find_tangents(around, time, time, x, 0);
  for (std::size_t q = 0; q < end_.size(); ++q) {
    any = kernels::gaps(int(x.rows()), x.data(), end_[q].normal.data(), end_[q].offset, drift_.heights[q].data()) || any;
  }
  if (!any) return false;
  set_planes();
  for (int q = 0; q < flat_; ++q) {
    if (!search_.covers(q, drift_.heights[q])) search_.look(q, drift_.heights[q], 0);
    for (const int s : search_.near(q)) deepest = std::min(deepest, samples_.at(s, drift_.heights[q].data()));
  }
  for (int q = flat_; q < int(end_.size()); ++q)
    deepest = std::min(deepest, samples_.at(tangents_.found()[q - flat_].sample, drift_.heights[q].data()));
  return true;
}

/// Moves the whole body by the shortest way that brings its samples in front of all planes, if there is one: that strains nothing.
void SurfaceContact::shift(Points& x) const {
  std::vector<Constraint> constraints;
  for (std::size_t q = 0; q < end_.size(); ++q) {
    const bool flat = int(q) < flat_;
    double least = samples_.at(flat ? 0 : tangents_.found()[q - flat_].sample, drift_.heights[q].data());
    for (int s = 1; flat && s < samples_.count(); ++s) least = std::min(least, samples_.at(s, drift_.heights[q].data()));
    constraints.push_back({.normal = end_[q].normal, .bound = -least});
  }
  FeasibleSet feasible(int(end_.size()));
  Vec3 by = Vec3::Zero();
  if (!feasible.project(constraints, position_slack * length_, by)) return;
  for (int axis = 0; axis < 3; ++axis) x.col(axis) += by[axis];
}

void SurfaceContact::count(const Drive& around, double time, const Points& x, std::vector<Count>& contacts) {
  know(around);
  std::ranges::fill(contacts, 0);
  if (solids_) tangents_.find(around, time, time, x, 0);
  for (const Tangent& each : tangents_.found()) ++contacts[each.obstacle];
  for (int q = 0; q < flat_; ++q) {
    for (const int s : near(q, around.planes[q].at(time), x)) contacts[q] += samples_.at(s, drift_.heights[q].data()) <= touching * length_;
  }
}

}  // namespace softffd
