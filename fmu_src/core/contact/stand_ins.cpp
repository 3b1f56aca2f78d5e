#include "contact/stand_ins.hpp"

#include "body/rigid_motion.hpp"
#include "contact/broad_phase.hpp"
#include "contact/surface/tangents.hpp"

namespace softffd {

namespace {

/// A point that may press on a face must be this fraction of the box's largest side inside the edge of the face, or as far as the point
/// and the solid may move if that is less.
constexpr double edge_fraction = 0.02;

/// Transforms a normal from the world to the frame of the solid, in which Plane::facing is given.
Vec3 facing_of(const Plane& solid, const SolidPose& pose, const Vec3& normal) {
  if (solid.box()) return pose.edges.transpose() * normal;
  return solid.length > 0 ? swung(pose.normal, solid.normal, normal) : normal;
}

/// Returns the unit normals of the flat faces of a solid.
std::vector<Vec3> faces_of(const Plane& solid) {
  std::vector<Vec3> faces;
  for (const double side : {1.0, -1.0}) {
    for (int axis = 0; axis < 3 && solid.box(); ++axis) faces.push_back(side * Vec3::Unit(axis));
    if (!solid.box() && solid.length > 0) faces.push_back(side * solid.normal);
  }
  return faces;
}

/// True if the projection of x onto the face in front of x lies on the face, at least `margin` [m] from the edge.
bool over_face(const Plane& solid, const SolidPose& pose, const Vec3& x, double margin) {
  const Vec3 arm = x - pose.point;
  if (!solid.box()) return (arm - pose.normal.dot(arm) * pose.normal).norm() <= solid.radius - margin;
  const Vec3 at = pose.edges.transpose() * arm;
  for (int axis = 0; axis < 3; ++axis)
    if (solid.facing[axis] == 0 && !(std::abs(at[axis]) <= 0.5 * solid.sides[axis] - margin)) return false;
  return true;
}

/// Chooses the supporting half-space that the body is farthest in front of. Returns true if it belongs to a flat face.
bool choose(Plane& solid, const SolidPose& pose, double t, const Points& x) {
  const Vec3 middle = x.colwise().mean().matrix().transpose();
  Vec3 best = facing_of(solid, pose, tangent(solid, pose, middle).normal);
  solid.facing = best;
  double furthest = least_gap(solid.at(t), x);
  bool flat = false;
  for (const Vec3& face : faces_of(solid)) {
    solid.facing = face;
    if (const double gap = least_gap(solid.at(t), x); gap >= furthest) furthest = gap, best = face, flat = true;
  }
  solid.facing = best;
  return flat;
}

/// True if a supporting half-space may stand for the solid during H. way: how far a point can move in H [m].
bool may_stand(const Body& body, Plane& solid, const State& state, double H, double way) {
  const SolidPose pose = solid.pose_at(state.time);
  const bool flat = choose(solid, pose, state.time, state.x);
  const HalfSpace here = solid.at(state.time);
  const double own = H * way_between(solid, state.time, state.time + H, radius_about(here.point, state.x)).speed;
  const double margin = std::min(way + own, edge_fraction * body.length);
  const auto clear = [&](const Vec3& place) { return here.gap(place) > way + own || (flat && over_face(solid, pose, place, margin)); };
  bool all = !body.samples->of_nodes();
  for (int p = 0; p < state.x.rows() && all; ++p) all = clear(row(state.x, p));
  if (all) return true;
  for (int s = 0; s < body.samples->count(); ++s)
    if (!clear(body.samples->at(s, state.x))) return false;
  return true;
}

}  // namespace

void let_half_spaces_stand(const Body& body, Drive& around, const State& state, double H) {
  meet_solids(around);
  double way = -1;
  for (Plane& plane : around.planes) {
    if (!plane.solid()) continue;
    if (way < 0) way = forecast_way({body, around}, state, H);
    if (may_stand(body, plane, state, H, way)) continue;
    plane.facing.setZero();
    return;
  }
}

}  // namespace softffd
