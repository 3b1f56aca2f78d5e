#include "contact/broad_phase.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "body/rigid_motion.hpp"
#include "contact/surface/tangents.hpp"
#include "model/arithmetic.hpp"

namespace softffd {

namespace {

/// Speeds inside a step may exceed those at its ends by this factor.
constexpr double speed_margin = 1.5;

/// Returns the smaller of two numbers, or NaN if either is NaN.
double smaller(double a, double b) { return a < b || a != a ? a : b; }

double largest_speed(const Points& v) { return std::sqrt(v.square().rowwise().sum().maxCoeff<Eigen::PropagateNaN>()); }

}  // namespace

double least_gap(const HalfSpace& obstacle, const Points& x) {
  double least = std::numeric_limits<double>::infinity();
  for (int p = 0; p < x.rows(); ++p) least = smaller(least, obstacle.gap(row(x, p)));
  return least;
}

double least_gap(const Body& body, const HalfSpace& obstacle, const Points& x) {
  if (!body.samples) return least_gap(obstacle, x);
  double least = std::numeric_limits<double>::infinity();
  Scalars heights(x.rows());
  kernels::gaps(int(x.rows()), x.data(), obstacle.normal.data(), obstacle.offset, heights.data());
  for (int s = 0; s < body.samples->count(); ++s) least = smaller(least, body.samples->at(s, heights.data()));
  return least;
}

Facing facing(const Body& body, const Plane& obstacle, double t, const Points& x) {
  if (const HalfSpace plane = obstacle.at(t); !obstacle.solid()) return {plane, least_gap(body, plane, x)};
  const SolidPose pose = obstacle.pose_at(t);
  Facing nearest{pose, std::numeric_limits<double>::infinity()};
  for (int s = 0; s < body.samples->count(); ++s) {
    const Vec3 place = body.samples->at(s, x);
    const HalfSpace here = tangent(obstacle, pose, place);
    if (const double gap = here.gap(place); !(gap >= nearest.gap)) nearest = {here, gap};
  }
  return nearest;
}

bool off_obstacles(const Drive& around, double t, const Points& x, double gap, double of_solids) {
  for (const Plane& plane : around.planes) {
    if (plane.solid()) {
      if (!(gap_between(plane, plane.pose_at(t), x) > std::max(gap, of_solids))) return false;
      continue;
    }
    const HalfSpace obstacle = plane.at(t);
    for (int p = 0; p < x.rows(); ++p)
      if (!(obstacle.gap(row(x, p)) > gap)) return false;
  }
  return true;
}

bool off_obstacles(const Body& body, const Drive& around, double t, const Points& x, double gap, double of_solids) {
  const bool in_hull = !body.samples || !body.samples->of_nodes();
  if (in_hull && off_obstacles(around, t, x, gap, of_solids)) return true;
  const auto off = [&](const Plane& plane) { return facing(body, plane, t, x).gap > (plane.solid() ? std::max(gap, of_solids) : gap); };
  return body.samples && std::all_of(around.planes.begin(), around.planes.end(), off);
}

double forecast_way(const Equations& equations, const State& state, double H) {
  const auto& [body, around] = equations;
  double acceleration = 0;
  for (int axis = 0; axis < 3; ++axis) acceleration = std::max(acceleration, (around.force.col(axis) / body.mass).abs().maxCoeff());
  return H * (largest_speed(state.v) + 0.5 * H * std::sqrt(3.0) * acceleration);
}

double BroadPhase::stiff_way(const Equations& equations, const State& state, double H, double vibration) {
  const auto& [body, around] = equations;
  if (!around.pins.empty()) return std::numeric_limits<double>::infinity();
  const RigidMotion now = rigid_motion(body.mass, state.x, state.v);
  middle_ = around.force.colwise() / body.mass;
  const RigidMotion change = rigid_motion(body.mass, state.x, middle_);
  const double radius = radius_about(now.centre, state.x);
  const double speed = now.velocity.norm() + radius * now.spin.norm(), acceleration = change.velocity.norm() + radius * change.spin.norm();
  return H * (speed + 0.5 * H * acceleration) + vibration;
}

double BroadPhase::least_gap(const HalfSpace& obstacle, const Points& x) {
  kernels::gaps(int(x.rows()), x.data(), obstacle.normal.data(), obstacle.offset, gap_.data());
  return (samples_ ? samples_->hull(gap_, room_) : gap_).minCoeff<Eigen::PropagateNaN>();
}

bool BroadPhase::may_touch(const Equations& equations, const State& state, double H, double way) {
  const Drive& around = equations.around;
  return std::any_of(around.planes.begin(), around.planes.end(), [&](const Plane& plane) {
    const HalfSpace start = plane.at(state.time);
    const double first = least_gap(start, state.x), last = least_gap(plane.at(state.time + H), state.x);
    const PlaneWay own = way_between(plane, state.time, state.time + H, radius_about(start.point, state.x));
    const double least = std::max(std::min(first, last) - own.deviation, 0.5 * (first + last - H * own.speed));  // bound in between
    return !(least > way);
  });
}

bool BroadPhase::passed(const Drive& around, double t0, double t1, const Points& x0, const Points& v0, const Points& x1, const Points& v1) {
  const double h = t1 - t0;
  middle_ = 1.5 * (x1 - x0) - 0.25 * h * (v0 + v1);  // h times the mid-step velocity of the cubic through both ends
  const double way = worse(speed_margin * h * worse(largest_speed(v0), largest_speed(v1)), largest_speed(middle_));
  return std::any_of(around.planes.begin(), around.planes.end(), [&](const Plane& plane) {
    const HalfSpace start = plane.at(t0);
    const double before = least_gap(start, x0), after = least_gap(plane.at(t1), x1);
    const PlaneWay own = way_between(plane, t0, t1, radius_about(start.point, x0) + way);
    return !(after >= 0) || !(after + before > way + std::min(2 * own.deviation, h * own.speed));
  });
}

}  // namespace softffd
