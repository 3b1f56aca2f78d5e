#include "contact/reach.hpp"

#include <algorithm>
#include <cmath>

#include "contact/tolerances.hpp"

namespace softffd {

namespace {

/// Speeds inside a step may exceed those at its ends by this factor.
constexpr double speed_margin = 1.5;

double largest_speed(const Points& v) { return std::sqrt(v.square().rowwise().sum().maxCoeff()); }

}  // namespace

double Reach::least_gap(const HalfSpace& obstacle, const Points& x) {
  kernels::gaps(int(x.rows()), x.data(), obstacle.normal.data(), obstacle.offset, gap_.data());
  return gap_.minCoeff();
}

bool Reach::may_touch(const Equations& equations, const State& state, double H) {
  const auto& [body, around] = equations;
  double acceleration = 0;
  for (int axis = 0; axis < 3; ++axis) acceleration = std::max(acceleration, (around.force.col(axis) / body.mass).abs().maxCoeff());
  const double way = H * (largest_speed(state.v) + 0.5 * H * std::sqrt(3.0) * acceleration);
  return std::any_of(around.planes.begin(), around.planes.end(), [&](const Plane& plane) {
    return std::min(least_gap(plane.at(state.time), state.x), least_gap(plane.at(state.time + H), state.x)) <= way;
  });
}

bool Reach::passed(const Drive& around, double t0, double t1, const Points& x0, const Points& v0, const Points& x1, const Points& v1) {
  const double way = speed_margin * (t1 - t0) * std::max(largest_speed(v0), largest_speed(v1));
  return std::any_of(around.planes.begin(), around.planes.end(), [&](const Plane& plane) {
    const double after = least_gap(plane.at(t1), x1);
    return after < 0 || after + least_gap(plane.at(t0), x0) <= way;
  });
}

bool Reach::clear(const Body& body, const Drive& around, double t, const Points& x) {
  return std::all_of(around.planes.begin(), around.planes.end(),
                     [&](const Plane& plane) { return least_gap(plane.at(t), x) > touching * body.length; });
}

}  // namespace softffd
