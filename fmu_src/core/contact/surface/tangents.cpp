#include "contact/surface/tangents.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/tolerances.hpp"
#include "machine/elementary.hpp"

namespace softffd {

namespace {

/// A list of samples reaches far_reach times as far as it must, plus nearest_reserve of the box, so that it is seldom made anew.
constexpr double far_reach = 16, nearest_reserve = 1e-2;

/// Edge radius of a free box as a fraction of its smallest side [1]. With it the box slides over samples that stand a little higher than
/// those that it presses down.
constexpr double free_edge = 5e-3;

/// If the cosine of the angle between a guide and a normal is not above this value, the obstacle cannot stop what moves along the guide.
constexpr double along_guide = 1e-6;

/// Largest number of moves out of obstacles, which may be needed one after the other.
constexpr int most_moves_out = 50;

HalfSpace half_space(const HalfSpace& pose, const Vec3& normal, double beyond) {
  return {pose.point, normal, normal.dot(pose.point) + beyond, pose.velocity, pose.spin};
}

/// Returns the supporting half-space of a box at the point closest to x. edge: radius of the edges of the box [m].
HalfSpace tangent_of_box(const Vec3& sides, double edge, const SolidPose& pose, const Vec3& x) {
  const Vec3 half = (0.5 * sides).array() - edge;
  const Vec3 at = pose.edges.transpose() * (x - pose.point), closest = at.cwiseMax(-half).cwiseMin(half), out = at - closest;
  if (const double distance = out.norm(); distance > 0) {
    const Vec3 normal = out / distance;
    return half_space(pose, pose.edges * normal, normal.dot(closest) + edge);
  }
  int face = 0;
  (half - at.cwiseAbs()).minCoeff(&face);
  return half_space(pose, at[face] < 0 ? Vec3(-pose.edges.col(face)) : Vec3(pose.edges.col(face)), half[face] + edge);
}

/// Returns the tangent `here` of a sample at `place`, both in the pose `start`, taken along with the solid to another pose.
HalfSpace carried(const Plane& solid, const SolidPose& start, const HalfSpace& here, const Vec3& place, const SolidPose& pose) {
  if (!solid.solid()) return pose;
  if (!solid.box()) return tangent(solid, pose, pose.point + swung(start.normal, pose.normal, place - start.point));
  return half_space(pose, pose.edges * (start.edges.transpose() * here.normal), here.offset - here.normal.dot(start.point));
}

}  // namespace

HalfSpace tangent(const Plane& solid, const SolidPose& pose, const Vec3& x) {
  if (solid.box()) return tangent_of_box(solid.sides, solid.own ? free_edge * solid.sides.minCoeff() : 0, pose, x);
  const Vec3 arm = x - pose.point;
  const bool sphere = solid.length == 0;
  const double height = sphere ? 0 : pose.normal.dot(arm), half = 0.5 * solid.length;
  const Vec3 across = sphere ? arm : Vec3(arm - height * pose.normal);
  const double distance = across.norm();
  const Vec3 aside = sphere ? pose.normal : pose.normal.unitOrthogonal();
  const Vec3 outward = distance > 0 ? Vec3(across / distance) : aside;
  if (sphere) return half_space(pose, outward, solid.radius);
  const Vec3 up = height < 0 ? Vec3(-pose.normal) : pose.normal;
  const double above = std::abs(height) - half, beside = distance - solid.radius;
  if (above > 0 && beside > 0) {  // the edge is closest
    const double away = hypotenuse(above, beside);
    return half_space(pose, (above * up + beside * outward) / away, (above * half + beside * solid.radius) / away);
  }
  return above >= beside ? half_space(pose, up, half) : half_space(pose, outward, solid.radius);
}

double Tangents::way(const Points& from, const Points& to) {
  move_ = to - from;
  return std::sqrt(samples_.hull(move_, room_).square().rowwise().sum().maxCoeff<Eigen::PropagateNaN>());
}

/// Returns by how much the gap of any sample to this solid may have decreased at most since `known` [m].
double Tangents::way_since(const Known& known, const Points& x, const SolidPose& pose, const Plane& solid) {
  const double turned = (solid.box() ? (pose.edges - known.pose.edges).norm() : (pose.normal - known.pose.normal).norm()) * solid.size();
  return way(known.x, x) + (pose.point - known.pose.point).norm() + turned;
}

HalfSpace facing_half_space(const Plane& obstacle, double time, const Vec3& x) {
  return obstacle.solid() ? tangent(obstacle, obstacle.pose_at(time), x) : obstacle.at(time);
}

HalfSpace facing_half_space(const Plane& obstacle, const SolidPose& pose, const Vec3& x) {
  return obstacle.solid() ? tangent(obstacle, pose, x) : HalfSpace(pose);
}

double gap_between(const Plane& solid, const SolidPose& pose, const Points& x) {
  const HalfSpace between = tangent(solid, pose, x.colwise().mean().matrix().transpose());
  double least = std::numeric_limits<double>::infinity();
  for (int p = 0; p < x.rows(); ++p) least = std::min(least, between.gap(row(x, p)));
  return least;
}

void Tangents::find(const Drive& around, double t0, double t1, const Points& x0, double way) {
  found_.clear();
  known_.resize(around.planes.size());
  way_ = way;
  for (std::size_t q = 0; q < around.planes.size(); ++q) {
    const Plane& solid = around.planes[q];
    if (!solid.solid()) continue;
    const SolidPose start = solid.pose_at(t0), middle = solid.pose_at(0.5 * (t0 + t1)), end = solid.pose_at(t1);
    const double own = (t1 - t0) * way_between(solid, t0, t1, solid.size()).speed;
    const double reach = way + own + touching * length_;
    Known& known = known_[q];
    const double moved = known.reserve < 0 ? 0 : way_since(known, x0, start, solid);
    if (moved + reach <= known.least) continue;
    known.reserve -= moved;
    if (!(known.reserve >= reach)) list(solid, start, x0, reach, known);
    known.x = x0;
    known.pose = start;
    known.least = known.reserve;
    for (const int s : known.near) {
      const Vec3 place = samples_.at(s, x0);
      const HalfSpace here = tangent(solid, start, place);
      const double gap = here.gap(place);
      known.least = std::min(known.least, gap);
      if (gap > reach) continue;
      const auto later = [&](const SolidPose& pose) { return carried(solid, start, here, place, pose); };
      const bool rests = solid.at_rest() || t0 == t1;
      found_.push_back({int(q), s, here, rests ? here : later(middle), rests ? here : later(end), solid.friction});
    }
  }
  if (samples_.all() > samples_.count()) find_between(around, t0, t1, way);
}

/// Finds the tangents between free obstacles and the other obstacles.
void Tangents::find_between(const Drive& around, double t0, double t1, double way) {
  const std::size_t objects = found_.size();
  const auto sphere = [](const Plane& solid) { return solid.solid() && samples_of(solid) == 1; };
  for (const FreeMotion& each : around.free) {
    if (each.body().plane < 0) continue;
    const StepPoses own = step_poses(around, t0, t1, each.body().plane);
    const double size = own.plane->size(), fast = way_between(*own.plane, t0, t1, size).speed;
    for (int q = 0; q < int(around.planes.size()); ++q) {
      const Plane& plane = around.planes[q];
      if (plane.own) continue;
      const HalfSpace facing = facing_half_space(plane, t0, own.start.point);
      const double arm = (own.start.point - facing.point).norm() + size;
      const double reach = way + (t1 - t0) * (fast + way_between(plane, t0, t1, arm).speed) + touching * length_;
      if (facing.gap(own.start.point) - size > reach) continue;
      const StepPoses other = step_poses(around, t0, t1, q);
      if (sphere(*own.plane) || !sphere(plane)) meet(own, other, reach);
      if (plane.solid() && !sphere(*own.plane)) meet(other, own, reach);
    }
  }
  std::sort(found_.begin() + objects, found_.end(),
            [](const Tangent& a, const Tangent& b) { return std::pair(a.obstacle, a.sample) < std::pair(b.obstacle, b.sample); });
}

Tangents::StepPoses Tangents::step_poses(const Drive& around, double t0, double t1, int obstacle) {
  const Plane& plane = around.planes[obstacle];
  return {obstacle, &plane, plane.pose_at(t0), plane.pose_at(0.5 * (t0 + t1)), plane.pose_at(t1)};
}

void Tangents::find_own(const Drive& around, double time) {
  found_.clear();
  if (samples_.all() > samples_.count()) find_between(around, time, time, 0);
}

/// In each round, moves every free obstacle out of others by the deepest of its samples.
StepStatus Tangents::move_out(const Drive& around, double time, std::vector<FreeState>& free, bool& moved) {
  for (int looks = 0; looks < most_moves_out; ++looks) {
    std::vector<double> deepest(free.size(), -free_touching * length_);
    std::vector<Vec3> by(free.size(), Vec3::Zero());
    find_own(around, time);
    for (const Tangent& each : found_) {
      const bool own = around.planes[each.solid].own;
      const FreeMotion& body = *around.planes[own ? each.solid : each.obstacle].own;
      const double gap = each.start.gap(each.place);
      if (!(gap < deepest[body.index()])) continue;
      deepest[body.index()] = gap;
      const Vec3 out = own ? each.start.normal : Vec3(-each.start.normal), &guide = body.body().guide;
      by[body.index()] = -gap * (body.body().guided() ? Vec3(guide / guide.dot(out)) : out);
    }
    if (std::ranges::all_of(by, [](const Vec3& each) { return each.isZero(0); })) return StepStatus::ok;
    for (std::size_t k = 0; k < free.size(); ++k) free[k].position += by[k];
    moved = true;
  }
  return StepStatus::impossible_planes;
}

void Tangents::forget_own() {
  std::erase_if(found_, [](const Tangent& each) { return each.solid >= 0; });
}

void Tangents::meet(const StepPoses& solid, const StepPoses& obstacle, double reach) {
  for (int n = 0; n < samples_of(*solid.plane); ++n)
    if (const std::optional<Tangent> met = meeting(solid, n, obstacle, reach)) found_.push_back(*met);
}

/// One of the two obstacles is free. If it has a guide, the guide takes all forces across it.
std::optional<Tangent> Tangents::meeting(const StepPoses& solid, int n, const StepPoses& obstacle, double reach) const {
  const Plane &own = *solid.plane, &other = *obstacle.plane;
  const std::optional<SolidSample> sample = sample_of(own, solid.start, n, other, obstacle.start);
  if (!sample) return {};
  const Vec3& place = sample->place;
  const HalfSpace here = facing_half_space(other, obstacle.start, sample->facing);
  if (here.gap(place) > reach) return {};
  const FreeBody& free = (own.own ? own : other).own->body();
  if (free.guided() && std::abs(free.guide.dot(here.normal)) <= along_guide) return {};
  const auto later = [&](const SolidPose& pose) { return carried(other, obstacle.start, here, sample->facing, pose); };
  const int number = samples_.count() + most_of_solid * solid.number + n;
  Tangent met{obstacle.number, number, here, later(obstacle.middle), later(obstacle.end), friction_between(own, other), solid.number};
  met.place = place;
  met.velocity = solid.start.material_velocity(place);
  met.flown = taken_along(own, solid.start, place, solid.end);
  met.nearest = sample_of(own, solid.end, n, other, obstacle.end).value_or(SolidSample{met.flown, met.flown}).place;
  return met;
}

void Tangents::renew_own(const Drive& around, double time) {
  const double any = std::numeric_limits<double>::infinity();
  for (Tangent& each : found_) {
    if (each.solid < 0) continue;
    const StepPoses solid = step_poses(around, time, time, each.solid), obstacle = step_poses(around, time, time, each.obstacle);
    each = meeting(solid, number_of(each), obstacle, any).value_or(each);
  }
}

double Tangents::gap_of(const Drive& around, const Tangent& own, const SolidPose& of_solid, const SolidPose& of_obstacle) const {
  const Plane &solid = around.planes[own.solid], &obstacle = around.planes[own.obstacle];
  const SolidSample sample =
      sample_of(solid, of_solid, number_of(own), obstacle, of_obstacle).value_or(SolidSample{own.nearest, own.nearest});
  return facing_half_space(obstacle, of_obstacle, sample.facing).gap(sample.place);
}

int Tangents::index(int obstacle, int sample) const {
  const auto key = [&](int obstacle, int sample) { return std::tuple(!samples_.of_object(sample), obstacle, sample); };
  const auto at =
      std::ranges::lower_bound(found_, key(obstacle, sample), {}, [&](const Tangent& each) { return key(each.obstacle, each.sample); });
  return at != found_.end() && at->obstacle == obstacle && at->sample == sample ? int(at - found_.begin()) : -1;
}

void Tangents::list(const Plane& solid, const SolidPose& pose, const Points& x0, double reach, Known& known) {
  known.reserve = far_reach * reach + nearest_reserve * length_;
  known.near.clear();
  if (const double apart = gap_between(solid, pose, samples_.hull(x0, room_)); apart > known.reserve) {
    known.reserve = apart;
    return;
  }
  double least = std::numeric_limits<double>::infinity();
  for (int s = 0; s < samples_.count(); ++s) {
    const Vec3 place = samples_.at(s, x0);
    const double gap = tangent(solid, pose, place).gap(place);
    least = std::min(least, gap);
    if (gap <= known.reserve) known.near.push_back(s);
  }
  known.reserve = std::max(known.reserve, least);
}

}  // namespace softffd
