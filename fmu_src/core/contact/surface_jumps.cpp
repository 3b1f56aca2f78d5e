/// Between steps: samples that planes have jumped over, and those that touch.
#include <algorithm>

#include "contact/surface_contact.hpp"
#include "contact/tolerances.hpp"

namespace softffd {

StepStatus SurfaceContact::clear_jumps(const Body& body, const Drive& around, double time, Points& x, bool& moved) {
  double deepest = 0;
  if (!gaps_at(around, time, x, deepest)) return StepStatus::ok;
  if (deepest >= -position_slack * (length_ + row(x, 0).norm())) return StepStatus::ok;
  if (std::none_of(body.pinned.begin(), body.pinned.end(), [](bool pinned) { return pinned; })) shift(x);
  if (body.version != version_) {
    version_ = body.version;
    h_ = -1;
    drift_.set_masses(body.inverse_mass.head(body.points()));
  }
  for (std::size_t q = 0; q < end_.size(); ++q)
    kernels::gaps(body.points(), x.data(), end_[q].normal.data(), end_[q].offset, drift_.heights[q].data());
  const std::vector<Count> none;
  const StepStatus status = fit(none, move_, 0, [](const SurfaceRow&) { return Vec3(Vec3::Zero()); });
  if (status != StepStatus::ok) return status;
  drift_.add_move(x);
  moved = true;
  return StepStatus::ok;
}

void SurfaceContact::look(const Points& x) {
  touching_.clear();
  for (int q = 0; q < int(end_.size()); ++q)
    for (const int s : near(q, end_[q], x))
      if (samples_.at(s, drift_.heights[q].data()) <= touching * length_) touching_.push_back({.row = {q, s}});
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
  for (std::size_t q = 0; q < end_.size(); ++q) {
    end_[q] = around.planes[q].at(time);
    any = kernels::gaps(int(x.rows()), x.data(), end_[q].normal.data(), end_[q].offset, drift_.heights[q].data()) || any;
  }
  if (!any) return false;
  set_planes();
  for (std::size_t q = 0; q < end_.size(); ++q) {
    if (!search_.covers(int(q), drift_.heights[q])) search_.look(int(q), drift_.heights[q], 0);
    for (const int s : search_.near(int(q))) deepest = std::min(deepest, samples_.at(s, drift_.heights[q].data()));
  }
  return true;
}

/// Moves the whole body by the shortest way that brings its samples in front of all planes, if there is one: that strains nothing.
void SurfaceContact::shift(Points& x) const {
  std::vector<Constraint> constraints;
  for (std::size_t q = 0; q < end_.size(); ++q) {
    double least = samples_.at(0, drift_.heights[q].data());
    for (int s = 1; s < samples_.count(); ++s) least = std::min(least, samples_.at(s, drift_.heights[q].data()));
    constraints.push_back({.normal = end_[q].normal, .bound = -least});
  }
  FeasibleSet feasible(int(end_.size()));
  Vec3 by = Vec3::Zero();
  if (!feasible.project(constraints, position_slack * length_, by)) return;
  for (int axis = 0; axis < 3; ++axis) x.col(axis) += by[axis];
}

void SurfaceContact::count(const Drive& around, double time, const Points& x, std::vector<Count>& contacts) {
  for (int q = 0; q < int(end_.size()); ++q) {
    contacts[q] = 0;
    for (const int s : near(q, around.planes[q].at(time), x)) contacts[q] += samples_.at(s, drift_.heights[q].data()) <= touching * length_;
  }
}

}  // namespace softffd
