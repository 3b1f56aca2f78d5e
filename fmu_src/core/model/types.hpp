/// The few types that every room of the core shares.
#pragma once
#include <Eigen/Core>
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

/// How a step ended. Anything but `ok` leaves the state as it was before the call. `contact_ahead` is between the methods and the
/// propagator: a method without contact came upon an obstacle.
enum class StepStatus {
  ok,
  contact_ahead,
  beside_solid,  ///< what stands for a solid is pressed where that is not (contact/stand_ins.hpp)
  impossible_planes,
  pin_behind_plane,
  zero_normal,
  zero_orientation,
  undecided,  ///< springs without length push apart points in no direction
  too_much_work,
  not_finite
};

}  // namespace softffd
