/// Solids in implicit steps: the supporting half-spaces that samples meet, and the own samples of solids.
#include <algorithm>

#include "contact/implicit/surface_touches.hpp"

namespace softffd {

namespace {

/// Largest change of a supporting half-space's normal at which a solution counts as settled [1]: its gap error is of second order in it.
constexpr double most_turn = 1e-6;

}  // namespace

/// Number of the plane in which the sample meets the obstacle; -1: in none.
int SurfaceTouches::plane_of(int obstacle, int sample) const {
  if (obstacle < flat_ && samples_.of_object(sample)) return obstacle;
  const int at = tangents_.index(obstacle, sample);
  return at < 0 ? -1 : flat_ + at;
}

/// Finds the supporting half-spaces of all samples that can come to a solid if no point goes further than `way` [m] from its place at the
/// start of the step. The forces at hand stay with their samples.
void SurfaceTouches::find_tangents(double way) {
  std::vector<std::pair<Count, Vec3>> known;
  for (const Force& each : forces_) known.push_back({number(each.row), each.force});
  tangents_.find(step_->equations.around, step_->t, step_->t + step_->h, step_->from.x, way);
  covered_ = true;
  planes_.resize(flat_);
  obstacle_.resize(flat_);
  friction_.resize(flat_);
  own_.resize(flat_);
  for (const Tangent& each : tangents_.found()) {
    planes_.push_back(each.end);
    obstacle_.push_back(each.obstacle);
    friction_.push_back(each.friction);
    own_.push_back(each.nearest);
  }
  set_normals();
  forces_.clear();
  for (const auto& [number, force] : known) {
    const int sample = int(number % samples_.all()), plane = plane_of(int(number / samples_.all()), sample);
    if (plane >= 0) forces_.push_back({{plane, sample}, force});
  }
}

/// Place of a contact constraint's sample at the start of the step [m].
Vec3 SurfaceTouches::begin_of(const SurfaceRow& row) const {
  return own(row) ? tangent_of(row.plane).place : samples_.at(row.sample, step_->from.x);
}

/// Place of the sample's material at the end, with control points at x and free bodies where they were placed [m].
Vec3 SurfaceTouches::material_of(const SurfaceRow& row, const Points& x) const {
  if (!own(row)) return samples_.at(row.sample, x);
  const int number = tangent_of(row.plane).solid;
  const Plane& solid = step_->equations.around.planes[number];
  const SolidPose start = solid.own ? solid.pose_of(step_->from.free[solid.own->index()]) : solid.pose_at(step_->t);
  return taken_along(solid, start, tangent_of(row.plane).place, poses_[number]);
}

/// Place of the sample at the end of the step, and the place from which its supporting half-space is looked for [m].
SolidSample SurfaceTouches::sample_of_row(const SurfaceRow& row, const Points& x) const {
  if (!own(row)) {
    const Vec3 place = samples_.at(row.sample, x);
    return {place, place};
  }
  const Tangent& found = tangent_of(row.plane);
  const std::vector<Plane>& planes = step_->equations.around.planes;
  const std::optional<SolidSample> sample =
      sample_of(planes[found.solid], poses_[found.solid], tangents_.number_of(found), planes[found.obstacle], poses_[found.obstacle]);
  if (sample) return *sample;
  const Vec3 place = material_of(row, x);
  return {place, place};
}

/// Largest way that the present forces move a free obstacle that may meet others [m].
double SurfaceTouches::way_of_free() const {
  double most = 0;
  if (samples_.all() == samples_.count()) return most;
  for (const FreeMotion& each : step_->equations.around.free) {
    if (each.body().plane < 0) continue;
    const FreeState &from = step_->from.free[each.index()], &end = free_bodies_[each.index()];
    const Twist& twist = free_rows_.twists()[each.index()];
    const double turned = (axes_of(end.orientation) - axes_of(from.orientation)).norm() + twist.turn.norm();
    const double size = step_->equations.around.planes[each.body().plane].size();
    most = std::max(most, (end.position + twist.move - from.position).norm() + size * turned);
  }
  return most;
}

/// The supporting half-space for the sample of `plane` at a place. A place behind the half-space that the sample faced at the start of the
/// step is projected onto its boundary first, so that no sample comes out of the other side of a thin solid.
HalfSpace SurfaceTouches::tangent_at(int plane, const Vec3& place) const {
  const HalfSpace& start = tangents_.found()[plane - flat_].end;
  const int solid = obstacle_[plane];
  if (solid < flat_) return end_[solid];
  return tangent(step_->equations.around.planes[solid], poses_[solid], place - std::min(start.gap(place), 0.0) * start.normal);
}

/// Turns the supporting half-spaces to where the samples are now; the forces turn with the normals.
void SurfaceTouches::turn_tangents(const StepProblem& problem) {
  const std::vector<Vec3> before = normals_;
  for (int q = flat_; q < int(planes_.size()); ++q) {
    const SurfaceRow row{q, tangent_of(q).sample};
    const SolidSample sample = sample_of_row(row, problem.x);
    own_[q] = sample.place;
    planes_[q] = tangent_at(q, sample.facing);
  }
  set_normals();
  for (Force& each : forces_)
    if (each.row.plane >= flat_) each.force = swung(before[each.row.plane], normals_[each.row.plane], each.force);
}

/// True if the supporting half-spaces still hold where the forces have brought the samples.
bool SurfaceTouches::tangents_stand(const StepProblem& problem) const {
  return std::ranges::all_of(forces_, [&](const Force& each) {
    if (each.row.plane < flat_) return true;
    Vec3 place = sample_of_row(each.row, problem.x).facing + samples_.at(each.row.sample, move_);
    if (free_rows_.any()) place += free_rows_.parting(each.row);
    return (tangent_at(each.row.plane, place).normal - normals_[each.row.plane]).norm() <= most_turn;
  });
}

}  // namespace softffd
