/// The few types that all parts of the core share.
#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>

namespace softffd {

/// A number of steps, matrices, contacts; 64 bits on every platform (`long` has 32 on Windows).
using Count = std::int64_t;
using Vec3 = Eigen::Vector3d;
using Scalars = Eigen::ArrayXd;
/// One row per control point, column-major: the x, y and z coordinates are three contiguous runs (structure of arrays).
using Points = Eigen::Array<double, Eigen::Dynamic, 3>;

inline Vec3 row(const Points& points, int p) { return {points(p, 0), points(p, 1), points(p, 2)}; }
inline void set_row(Points& points, int p, const Vec3& value) { points.row(p) = value.array().transpose(); }

/// Time integration methods. `automatic` selects one of the others for each communication step: `backward_euler` only for a stiff body in
/// contact, `sdirk2` only for a body with internal damping in contact or on pins, `floating_frame` only for one that flies and turns.
enum class Method { automatic, central_difference, leapfrog, bm4, rkn12, dop853, ros34pw2, backward_euler, sdirk2, floating_frame };
constexpr Method last(Method) { return Method::floating_frame; }
inline constexpr std::size_t method_count = std::size_t(Method::floating_frame) + 1;

/// How a step ended. With any status but `ok` the state is as it was before the call. `contact_ahead` is used between the methods and the
/// propagator: a method without contact came upon an obstacle.
enum class StepStatus {
  ok,
  contact_ahead,
  beside_solid,  ///< a half-space that replaces a solid is pressed where the solid is not (contact/stand_ins.hpp)
  impossible_planes,
  pin_behind_plane,
  zero_normal,
  zero_orientation,
  undecided,  ///< springs of zero length would push points apart, but in no definite direction
  too_much_work,
  not_finite
};

}  // namespace softffd
