/// Between steps: samples that planes have jumped over, and samples that touch.
#include <algorithm>

#include "contact/surface/surface_contact.hpp"
#include "contact/tolerances.hpp"

namespace softffd {

namespace {

/// Largest number of moves out of solids, which may be needed one after the other.
constexpr int most_jump_looks = 50;

}  // namespace

StepStatus SurfaceContact::clear_jumps(const Body& body, const Drive& around, double time, Points& x, bool& moved) {
  double way = 0;  // twice the largest move of a point: samples this near to a solid are kept off it by the next move
  const auto clear = [&] {
    double deepest = 0;
    return !gaps_at(around, time, x, way, deepest) ||
           deepest >= -std::max(position_slack * (length_ + row(x, 0).norm()), 2 * slack_of_rows());  // what `fit` leaves
  };
  know(around, time);
  drift_.set_free(nullptr);           // bodies stay where they are
  std::ranges::fill(friction_, 0.0);  // no friction in a jump
  if (clear()) return StepStatus::ok;
  if (body.version != version_) {
    version_ = body.version;
    h_ = -1;
    drift_.set_masses(body.inverse_mass.head(body.points()));
  }
  const bool free = std::none_of(body.pinned.begin(), body.pinned.end(), [](bool pinned) { return pinned; });
  for (int looks = 0; looks < most_jump_looks; ++looks) {
    const Points before = x;
    if (free) shift(x);
    set_planes();
    find_gaps(x);
    const std::vector<Count> none;
    const StepStatus status = fit(none, {}, 0, [](const SurfaceRow&) { return Vec3(Vec3::Zero()); });
    if (status != StepStatus::ok) return status;
    x += drift_.move();
    way = std::max(way, 2 * tangents_.way(before, x));
    moved = true;
    if (!solids_ || clear()) return StepStatus::ok;  // other samples may have come to solids
  }
  return StepStatus::impossible_planes;
}

void SurfaceContact::look(const Drive& around, double time, const Points& x) {
  touching_.clear();
  for (int q = 0; q < flat_; ++q)
    for (const int s : near(q, x))
      if (drift_.gaps[q].at(samples_, s) <= touching * length_) touching_.push_back({.row = {q, s}});
  if (solids_) find_tangents(around, time, time, x, 0);
  for (int q = flat_; q < int(end_.size()); ++q) touching_.push_back({.row = {q, tangents_.found()[q - flat_].sample}});
  lasting_ = touching_;
  holds_ = true;
}

/// Returns the samples near plane q in its current position, among them all that touch it. Their gaps are those of drift_.
const std::vector<int>& SurfaceContact::near(int q, const Points& x) {
  GapFunction& gaps = drift_.gaps[q];
  gaps.find(samples_, x, end_[q].normal, end_[q].offset);
  if (!search_.covers(q, gaps.of_points)) search(q, gaps.of_points, 0);
  return search_.near(q);
}

/// Finds the tangents and the gaps above the planes. deepest: lowered to the least gap of the samples [m]. Returns whether any control
/// point is behind a plane.
bool SurfaceContact::gaps_at(const Drive& around, double time, const Points& x, double way, double& deepest) {
  if (solids_) find_tangents(around, time, time, x, way, false);
  if (!find_gaps(x)) return false;
  for (int q = 0; q < flat_; ++q) {
    if (!search_.covers(q, drift_.gaps[q].of_points)) search(q, drift_.gaps[q].of_points, 0);
    for (const int s : search_.near(q)) deepest = std::min(deepest, drift_.gaps[q].at(samples_, s));
  }
  for (int q = flat_; q < int(end_.size()); ++q)
    deepest = std::min(deepest, drift_.gaps[q].at(samples_, tangents_.found()[q - flat_].sample));
  return true;
}

/// Translates the whole body by the shortest way that brings its samples in front of all planes, if there is one: that causes no strain.
void SurfaceContact::shift(Points& x) const {
  std::vector<Constraint> constraints;
  for (std::size_t q = 0; q < end_.size(); ++q) {
    const bool flat = int(q) < flat_;
    double least = drift_.gaps[q].at(samples_, flat ? 0 : drift_.gaps[q].sample);
    for (int s = 1; flat && s < samples_.count(); ++s) least = std::min(least, drift_.gaps[q].at(samples_, s));
    constraints.push_back({.normal = end_[q].normal, .bound = -least});
  }
  FeasibleSet feasible(int(end_.size()));
  Vec3 by = Vec3::Zero();
  if (!feasible.project(constraints, position_slack * length_, by)) return;
  for (int axis = 0; axis < 3; ++axis) x.col(axis) += by[axis];
}

void SurfaceContact::count(const Drive& around, double time, const Points& x, std::vector<Count>& contacts) {
  know(around, time);
  std::ranges::fill(contacts, 0);
  if (solids_) tangents_.find(around, time, time, x, 0);
  tangents_.forget_own();
  for (const Tangent& each : tangents_.found()) ++contacts[each.obstacle];
  for (int q = 0; q < flat_; ++q) {
    for (const int s : near(q, x)) contacts[q] += drift_.gaps[q].at(samples_, s) <= touching * length_;
  }
}

}  // namespace softffd
