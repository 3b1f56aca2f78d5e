#include "contact/free/solid_samples.hpp"

#include <algorithm>

#include "contact/surface/tangents.hpp"

namespace softffd {

namespace {

constexpr int corners = 8, edges = 12, on_rim = 8;
/// If the tilt of a rim is below this value, none of its points counts as lowest, because noise would turn the samples round [rad].
constexpr double level = 1e-5;
/// Cosine of an eighth of a turn.
constexpr double half_root = 0.70710678118654752440;
constexpr double cosines[on_rim] = {1, half_root, 0, -half_root, -1, -half_root, 0, half_root};
/// The ends of the part of an edge that lies over a face are shifted inwards by this fraction of the edge's length [1].
constexpr double within = 1e-6;

struct Segment {
  Vec3 from, to;
  Vec3 at(double fraction) const { return from + fraction * (to - from); }
};
/// Part of a segment between two fractions of its length; empty if `begin` exceeds `end`. out: normal of the face that the part is over.
struct Part {
  double begin = 0, end = 1;
  Vec3 out = Vec3::Zero();
  void cut(double at, double slope, double most) {  // |at + fraction slope| <= most
    if (slope == 0) {
      if (std::abs(at) > most) end = -1;
      return;
    }
    const double one = (-most - at) / slope, other = (most - at) / slope;
    begin = std::max(begin, std::min(one, other));
    end = std::min(end, std::max(one, other));
  }
};

Vec3 corner(const PlaneMotion& box, const SolidPose& pose, int n) {
  const Vec3 side(n & 1 ? 0.5 : -0.5, n & 2 ? 0.5 : -0.5, n & 4 ? 0.5 : -0.5);
  return pose.point + pose.edges * side.cwiseProduct(box.sides);
}

/// Edge e, along axis e / 4.
Segment edge(const PlaneMotion& box, const SolidPose& pose, int e) {
  const int axis = e / 4, one = (axis + 1) % 3, other = (axis + 2) % 3;
  const int from = (e & 1) << one | (e >> 1 & 1) << other;
  return {corner(box, pose, from), corner(box, pose, from | 1 << axis)};
}

/// Returns the part of a segment over the face of a box that the segment is farthest in front of.
Part over_box(const PlaneMotion& box, const SolidPose& pose, const Segment& segment) {
  const Vec3 half = 0.5 * box.sides, from = pose.edges.transpose() * (segment.from - pose.point);
  const Vec3 to = pose.edges.transpose() * (segment.to - pose.point), slope = to - from;
  int face;
  (from.cwiseMin(to).cwiseMax(-from.cwiseMax(to)) - half).maxCoeff(&face);
  Part part{.out = from[face] + to[face] < 0 ? Vec3(-pose.edges.col(face)) : Vec3(pose.edges.col(face))};
  for (int axis = 0; axis < 3; ++axis)
    if (axis != face) part.cut(from[axis], slope[axis], half[axis]);
  return part;
}

/// Returns the part of a segment over an end of a cylinder, or, over the lateral surface, the one point that is nearest to the axis.
Part over_cylinder(const PlaneMotion& cylinder, const SolidPose& pose, const Segment& segment) {
  const Vec3 arm = segment.from - pose.point, way = segment.to - segment.from;
  const double height = pose.normal.dot(arm), rise = pose.normal.dot(way), half = 0.5 * cylinder.length;
  const Vec3 out = tangential(pose.normal, arm), slope = tangential(pose.normal, way);
  const double square = slope.squaredNorm(), nearest = square > 0 ? std::clamp(-out.dot(slope) / square, 0.0, 1.0) : 0;
  const Vec3 closest = out + nearest * slope;
  const double apart = closest.norm();
  if (std::max(std::min(height, height + rise), std::min(-height, -height - rise)) - half < apart - cylinder.radius) {
    Part part{.out = apart > 0 ? Vec3(closest / apart) : pose.normal.unitOrthogonal()};
    part.cut(height, rise, half);
    if (part.begin < part.end) part.begin = part.end = std::clamp(nearest, part.begin, part.end);
    return part;
  }
  Part part{.out = 2 * height + rise < 0 ? Vec3(-pose.normal) : pose.normal};
  if (apart >= cylinder.radius || square == 0) return {1, 0, part.out};
  const double middle = -out.dot(slope) / square, least = (out + middle * slope).squaredNorm();
  part.cut(-middle, 1, std::sqrt((cylinder.radius * cylinder.radius - least) / square));
  return part;
}

/// Returns end n of the part of a segment that lies over the other obstacle; none if this is an end of the segment itself.
std::optional<SolidSample> end_over(const Segment& segment, int n, const Plane& other, const SolidPose& its_pose) {
  if (!other.solid() || samples_of(other) == 1 || (other.own && other.box())) return {};
  const Part part = other.box() ? over_box(other, its_pose, segment) : over_cylinder(other, its_pose, segment);
  if (part.begin > part.end) return {};
  const double fraction = n == 0 ? part.begin + within : part.end - within;
  if (fraction < 2 * within || fraction > 1 - 2 * within || (n == 1 && part.end - part.begin < 4 * within)) return {};
  const Vec3 place = segment.at(fraction);
  return SolidSample{place, place + (2 * other.size() + std::abs(part.out.dot(place - its_pose.point))) * part.out};
}

}  // namespace

int samples_of(const PlaneMotion& solid) {
  if (solid.box()) return corners + 2 * edges;
  return solid.length > 0 ? 2 * on_rim + 2 : 1;
}

std::optional<SolidSample> sample_of(const PlaneMotion& solid, const SolidPose& pose, int n, const Plane& other,
                                     const SolidPose& its_pose) {
  if (solid.box()) {
    if (const Vec3 place = corner(solid, pose, n % corners); n < corners) return SolidSample{place, place};
    return end_over(edge(solid, pose, (n - corners) / 2), (n - corners) % 2, other, its_pose);
  }
  const Vec3 normal = facing_half_space(other, its_pose, pose.point).normal;
  if (solid.length == 0) return SolidSample{pose.point - solid.radius * normal, pose.point};
  const Vec3& axis = pose.normal;
  Vec3 lowest = -tangential(axis, normal);
  const double size = lowest.norm();
  lowest = size > level ? Vec3(lowest / size) : axis.unitOrthogonal();
  const Vec3 half = 0.5 * solid.length * axis;
  if (n >= 2 * on_rim) {
    const Vec3 line = pose.point + solid.radius * lowest;
    return end_over({line - half, line + half}, n - 2 * on_rim, other, its_pose);
  }
  const int k = n % on_rim;
  const Vec3 out = cosines[k] * lowest + cosines[(k + 6) % on_rim] * axis.cross(lowest);
  const Vec3 place = pose.point + (n < on_rim ? Vec3(-half) : half) + solid.radius * out;
  return SolidSample{place, place};
}

double own_gap(const Plane& free, const Plane& other, double time) {
  const SolidPose pose = free.pose_at(time), its_pose = other.pose_at(time);
  double least = std::numeric_limits<double>::infinity();
  const auto look = [&](const Plane& solid, const SolidPose& own, const Plane& at, const SolidPose& there) {
    for (int n = 0; n < samples_of(solid); ++n)
      if (const auto sample = sample_of(solid, own, n, at, there))
        least = std::min(least, facing_half_space(at, there, sample->facing).gap(sample->place));
  };
  look(free, pose, other, its_pose);
  if (other.solid()) look(other, its_pose, free, pose);
  return least;
}

bool free_off_others(const std::vector<Plane>& planes, double time, double gap) {
  for (const Plane& free : planes)
    for (const Plane& other : planes)
      if (free.own && !other.own && !(own_gap(free, other, time) > gap)) return false;
  return true;
}

double friction_between(const Plane& one, const Plane& other) {
  const Plane &free = one.own ? one : other, &held = one.own ? other : one;
  return free.own->body().guided() ? 0 : held.friction;
}

Vec3 taken_along(const Plane& solid, const SolidPose& from, const Vec3& place, const SolidPose& to) {
  const Vec3 arm = place - from.point;
  if (solid.box() || solid.own) return to.point + to.edges * (from.edges.transpose() * arm);
  return to.point + swung(from.normal, to.normal, arm);
}

}  // namespace softffd
