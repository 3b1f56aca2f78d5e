/// Solids among the obstacles of the surface: their supporting half-spaces, found anew in each step, are planes for one sample each.
#include <algorithm>

#include "contact/surface/surface_contact.hpp"
#include "contact/tolerances.hpp"

namespace softffd {

namespace {

/// Operations to find a supporting half-space, and to evaluate the gap of its sample throughout a step.
constexpr double tangent_work = 1500;

}  // namespace

/// Sets the obstacles at this time. Solids that are met as themselves come last; their rows are on supporting half-spaces only.
void SurfaceContact::know(const Drive& around, double time) {
  const int flat = int(std::ranges::count_if(around.planes, [](const Plane& plane) { return !plane.solid(); }));
  solids_ = around.planes.back().solid();
  if (solids_ || flat != flat_) {
    touching_.clear();
    lasting_.clear();
  }
  flat_ = flat;
  tangents_.forget();
  resize(flat_);
  for (int q = 0; q < flat_; ++q) {
    obstacle_[q] = q;
    alone_[q] = -1;
    friction_[q] = around.planes[q].friction;
    still_[q] = around.planes[q].at_rest();
    start_[q] = middle_[q] = end_[q] = around.planes[q].at(time);
  }
  poses_.clear();
  if (std::ranges::any_of(around.planes, &Plane::stood_for))
    for (int q = 0; q < flat_; ++q) poses_.push_back(around.planes[q].pose_at(time));
  set_planes();
}

/// Finds out whether the active rows, at their places, press on the solids for which half-spaces stand.
StepStatus SurfaceContact::pressed_solids(const StepView& step, const SurfaceStage& stage) const {
  for (std::size_t t = 0; t < stage.rows.size() && !poses_.empty(); ++t) {
    const int q = stage.rows[t].plane;
    if (q >= flat_ || !step.around.planes[q].stood_for()) continue;
    if (!step.around.planes[q].holds(poses_[q], places_[t], touching * length_)) return StepStatus::beside_solid;
  }
  return StepStatus::ok;
}

void SurfaceContact::resize(std::size_t planes) {
  for (auto* each : {&start_, &middle_, &end_}) each->resize(planes);
  friction_.resize(planes);
  obstacle_.resize(planes);
  alone_.resize(planes);
  own_.resize(planes, Vec3::Zero());
}

/// Finds the supporting half-spaces for samples that can come to a solid from t0 to t1, if no point moves further than `way` [m].
void SurfaceContact::find_tangents(const Drive& around, double t0, double t1, const Points& x0, double way, bool own) {
  std::vector<std::pair<Count, Candidate>> lasting;
  for (const Candidate& candidate : lasting_) lasting.push_back({number(candidate.row), candidate});
  tangents_.find(around, t0, t1, x0, way);
  if (!own) tangents_.forget_own();
  resize(flat_ + tangents_.found().size());
  found_ += double(tangents_.found().size()) * tangent_work;
  int q = flat_;
  for (const Tangent& each : tangents_.found()) {
    start_[q] = each.start;
    middle_[q] = each.middle;
    end_[q] = each.end;
    friction_[q] = each.friction;
    alone_[q] = each.sample;
    own_[q] = each.place;
    obstacle_[q++] = each.obstacle;
  }
  set_planes();
  lasting_.clear();
  for (auto& [known, candidate] : lasting) {
    if (candidate.row.plane >= flat_) {
      const auto [at_obstacle, sample] = row_of(known);
      const int at = tangents_.index(at_obstacle % int(still_.size()), sample);
      if (at < 0) continue;
      candidate.row.plane = flat_ + at;
    }
    lasting_.push_back(candidate);
  }
}

/// Replaces the supporting half-spaces at the start of the drift by those at its end. Each half of an impulse then has the direction of
/// one of them, which is second order.
void SurfaceContact::turn_tangents(const StepView& step, const Points& x1) {
  tangents_.renew_own(step.around, step.t1);
  for (std::size_t i = 0; i < tangents_.found().size(); ++i) {
    const Tangent& each = tangents_.found()[i];
    const Plane& solid = step.around.planes[each.obstacle];
    end_[flat_ + i] = each.solid < 0 ? tangent(solid, solid.pose_at(step.t1), samples_.at(each.sample, x1)) : each.start;
    own_[flat_ + i] = each.place;
  }
  set_planes();
}

}  // namespace softffd
