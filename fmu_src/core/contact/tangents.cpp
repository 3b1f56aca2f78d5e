#include "contact/tangents.hpp"

#include <algorithm>
#include <cmath>

#include "contact/tolerances.hpp"

namespace softffd {

namespace {

/// A list of samples reaches so many times as far as it must, and at least this share of the box further: it is seldom made anew.
constexpr double far_reach = 16, least_reserve = 1e-2;

double largest_row(const Points& x) { return std::sqrt(x.square().rowwise().sum().maxCoeff()); }

/// v as the shortest turn from one unit vector to the other takes it.
Vec3 swung(const Vec3& from, const Vec3& to, const Vec3& v) {
  const Vec3 axis = from.cross(to);
  const double cosine = from.dot(to);
  if (axis.isZero(0) || cosine <= -1) return v;  // a solid of revolution looks alike from both ends
  return v + axis.cross(v) + axis.cross(axis.cross(v)) / (1 + cosine);
}

HalfSpace half_space(const HalfSpace& pose, const Vec3& normal, double beyond) {
  return {pose.point, normal, normal.dot(pose.point) + beyond, pose.velocity, pose.spin};
}

}  // namespace

HalfSpace tangent(const Plane& solid, const HalfSpace& pose, const Vec3& x) {
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
    const double away = std::hypot(above, beside);
    return half_space(pose, (above * up + beside * outward) / away, (above * half + beside * solid.radius) / away);
  }
  return above >= beside ? half_space(pose, up, half) : half_space(pose, outward, solid.radius);
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
    look(solid, start, x0, reach, known_[q]);
    for (const int s : known_[q].near) {
      const Vec3 place = samples_.at(s, x0);
      const HalfSpace here = tangent(solid, start, place);
      if (here.gap(place) > reach) continue;
      const auto later = [&](const HalfSpace& pose) {
        return tangent(solid, pose, pose.point + swung(start.normal, pose.normal, place - start.point));
      };
      const bool rests = solid.at_rest() || t0 == t1;
      found_.push_back({int(q), s, here, rests ? here : later(middle), rests ? here : later(end)});
    }
  }
}

/// Makes the list of samples anew where it may not hold all that are within reach.
void Tangents::look(const Plane& solid, const HalfSpace& pose, const Points& x0, double reach, Known& known) const {
  if (known.reserve >= 0) {
    const double turned = (pose.normal - known.pose.normal).norm() * solid.size();
    const double moved = largest_row(x0 - known.x) + (pose.point - known.pose.point).norm() + turned;
    if (moved + reach <= known.reserve) return;
  }
  known.reserve = far_reach * reach + least_reserve * length_;
  known.x = x0;
  known.pose = pose;
  known.near.clear();
  double apart = 0;  // of the solid's ball from the box of the control points
  for (int axis = 0; axis < 3; ++axis)
    apart = std::max({apart, x0.col(axis).minCoeff() - pose.point[axis], pose.point[axis] - x0.col(axis).maxCoeff()});
  if (apart > solid.size() + known.reserve) return;
  for (int s = 0; s < samples_.count(); ++s) {
    const Vec3 place = samples_.at(s, x0);
    if (tangent(solid, pose, place).gap(place) <= known.reserve) known.near.push_back(s);
  }
}

}  // namespace softffd
