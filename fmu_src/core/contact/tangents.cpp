#include "contact/tangents.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/tolerances.hpp"

namespace softffd {

namespace {

/// A list of samples reaches so many times as far as it must, and at least this share of the box further: it is seldom made anew.
constexpr double far_reach = 16, least_reserve = 1e-2;

/// By how much any point's gap to a solid of this size may have become smaller.
double way_since(const Points& x0, const HalfSpace& pose0, const Points& x, const HalfSpace& pose, double size) {
  const double moved = std::sqrt((x - x0).square().rowwise().sum().maxCoeff());
  const double turned = ((pose.normal - pose0.normal).norm() + (pose.across - pose0.across).norm()) * size;
  return moved + (pose.point - pose0.point).norm() + turned;
}

/// Rows: the axes of a box.
Eigen::Matrix3d axes(const HalfSpace& pose) {
  Eigen::Matrix3d frame;
  frame << pose.across.transpose(), pose.normal.cross(pose.across).transpose(), pose.normal.transpose();
  return frame;
}

/// The place that goes with a solid, in another pose of it.
Vec3 carried(const Plane& solid, const HalfSpace& from, const HalfSpace& to, const Vec3& place) {
  const Vec3 arm = place - from.point;
  return to.point + (solid.box() ? Vec3(axes(to).transpose() * (axes(from) * arm)) : swung(from.normal, to.normal, arm));
}

HalfSpace half_space(const HalfSpace& pose, const Vec3& normal, double beyond) {
  return {pose.point, normal, normal.dot(pose.point) + beyond, pose.velocity, pose.spin};
}

/// From outside the closest point is within the sides; from inside the face that is nearest faces the place.
HalfSpace tangent_of_box(const Vec3& half, const HalfSpace& pose, const Vec3& arm) {
  const Eigen::Matrix3d frame = axes(pose);
  const Vec3 place = frame * arm, closest = place.cwiseMax(-half).cwiseMin(half), away = place - closest;
  if (const double distance = away.norm(); distance > 0) {
    const Vec3 normal = away / distance;
    return half_space(pose, frame.transpose() * normal, normal.dot(closest));
  }
  int axis = 0;
  (place.cwiseAbs() - half).maxCoeff(&axis);
  return half_space(pose, (place[axis] < 0 ? -1 : 1) * frame.row(axis).transpose(), half[axis]);
}

}  // namespace

HalfSpace tangent(const Plane& solid, const HalfSpace& pose, const Vec3& x) {
  const Vec3 arm = x - pose.point;
  if (solid.box()) return tangent_of_box(solid.half, pose, arm);
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
    const double away = std::hypot(above, beside);
    return half_space(pose, (above * up + beside * outward) / away, (above * half + beside * solid.radius) / away);
  }
  return above >= beside ? half_space(pose, up, half) : half_space(pose, outward, solid.radius);
}

double gap_between(const Plane& solid, const HalfSpace& pose, const Points& x) {
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
    const HalfSpace start = solid.at(t0), middle = solid.at(0.5 * (t0 + t1)), end = solid.at(t1);
    const double size = solid.size(), own = (t1 - t0) * way_between(solid, t0, t1, size).speed;
    const double reach = way + own + touching * length_;
    Known& known = known_[q];
    const double moved = known.reserve < 0 ? 0 : way_since(known.x, known.pose, x0, start, size);
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
      const auto later = [&](const HalfSpace& pose) { return tangent(solid, pose, carried(solid, start, pose, place)); };
      const bool rests = solid.at_rest() || t0 == t1;
      found_.push_back({int(q), s, here, rests ? here : later(middle), rests ? here : later(end)});
    }
  }
}

void Tangents::list(const Plane& solid, const HalfSpace& pose, const Points& x0, double reach, Known& known) const {
  known.reserve = far_reach * reach + least_reserve * length_;
  known.near.clear();
  if (const double apart = gap_between(solid, pose, x0); apart > known.reserve) {
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
