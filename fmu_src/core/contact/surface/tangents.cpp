#include "contact/surface/tangents.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/tolerances.hpp"
#include "machine/elementary.hpp"

namespace softffd {

namespace {

/// A list of samples reaches so many times as far as it must, and at least this share of the box further: it is seldom made anew.
constexpr double far_reach = 16, nearest_reserve = 1e-2;

/// Radius of a free box's edges in its smallest side [1]: it slides over samples that stand a little higher than those that it presses
/// down.
constexpr double free_edge = 5e-3;

/// Cosine of the angle between a guide and a normal below which an obstacle cannot stop what goes along the guide.
constexpr double along_guide = 1e-6;

HalfSpace half_space(const HalfSpace& pose, const Vec3& normal, double beyond) {
  return {pose.point, normal, normal.dot(pose.point) + beyond, pose.velocity, pose.spin};
}

/// Of a box, at the point that is closest.
/// edge: radius of its edges [m].
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

/// The tangent of a sample at this place of the start, taken along with the solid to another pose.
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

/// By how much any sample's gap to a solid of this size may have become smaller.
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

/// Of free obstacles and the others.
void Tangents::find_between(const Drive& around, double t0, double t1, double way) {
  const std::size_t objects = found_.size();
  const std::vector<Plane>& planes = around.planes;
  for (const FreeMotion& each : around.free) {
    const int own = each.body().plane;
    if (own < 0) continue;
    const SolidPose pose = planes[own].pose_at(t0);
    const double size = planes[own].size(), fast = way_between(planes[own], t0, t1, size).speed;
    for (int other = 0; other < int(planes.size()); ++other) {
      if (planes[other].own) continue;
      const HalfSpace facing = facing_half_space(planes[other], t0, pose.point);
      const double arm = (pose.point - facing.point).norm() + size;
      const double reach = way + (t1 - t0) * (fast + way_between(planes[other], t0, t1, arm).speed) + touching * length_;
      if (facing.gap(pose.point) - size > reach) continue;
      const auto sphere = [&](int q) { return planes[q].solid() && samples_of(planes[q]) == 1; };
      const bool flat = !planes[other].solid();
      if (sphere(own) || !sphere(other)) meet(around, t0, t1, reach, own, other);
      if (!flat && !sphere(own)) meet(around, t0, t1, reach, other, own);
    }
  }
  std::sort(found_.begin() + objects, found_.end(),
            [](const Tangent& a, const Tangent& b) { return std::pair(a.obstacle, a.sample) < std::pair(b.obstacle, b.sample); });
}

void Tangents::find_own(const Drive& around, double time) {
  found_.clear();
  if (samples_.all() > samples_.count()) find_between(around, time, time, 0);
}

void Tangents::forget_own() {
  std::erase_if(found_, [](const Tangent& each) { return each.solid >= 0; });
}

/// One is free; a guide takes what is across it.
void Tangents::meet(const Drive& around, double t0, double t1, double reach, int solid, int obstacle) {
  const FreeMotion& own = around.planes[solid].own ? *around.planes[solid].own : *around.planes[obstacle].own;
  for (int n = 0; n < samples_of(around.planes[solid]); ++n) {
    const std::optional<Tangent> met = meeting(around, t0, t1, solid, n, obstacle);
    if (!met || met->start.gap(met->place) > reach) continue;
    if (own.body().guided() && std::abs(own.body().guide.dot(met->start.normal)) <= along_guide) continue;
    found_.push_back(*met);
  }
}

std::optional<Tangent> Tangents::meeting(const Drive& around, double t0, double t1, int solid, int n, int obstacle) const {
  const Plane &own = around.planes[solid], &other = around.planes[obstacle];
  const SolidPose start = own.pose_at(t0), end = own.pose_at(t1), before = other.pose_at(t0);
  const std::optional<SolidSample> sample = sample_of(own, start, n, other, before);
  if (!sample) return {};
  const Vec3& place = sample->place;
  const HalfSpace here = facing_half_space(other, before, sample->facing);
  const auto later = [&](double time) { return carried(other, before, here, sample->facing, other.pose_at(time)); };
  Tangent met{obstacle, samples_.count() + most_of_solid * solid + n, here, later(0.5 * (t0 + t1)), later(t1), 0, solid};
  const Plane& free = own.own ? own : other;
  met.friction = free.own->body().guided() ? 0 : (own.own ? other : own).friction;
  met.place = place;
  met.velocity = start.material_velocity(place);
  met.flown = taken_along(own, start, place, end);
  met.nearest = sample_of(own, end, n, other, other.pose_at(t1)).value_or(SolidSample{met.flown, met.flown}).place;
  return met;
}

void Tangents::renew_own(const Drive& around, double time) {
  for (Tangent& each : found_)
    if (each.solid >= 0) each = meeting(around, time, time, each.solid, number_of(each), each.obstacle).value_or(each);
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
