/// Tolerances for rounding in contact with planes. Positions have errors of some 1e-16 of the box and of their distance from the origin.
#pragma once
#include <limits>

namespace softffd {

/// A gap of at most this fraction of the box's largest side counts as contact.
inline constexpr double touching = 1e-12;
/// The same of a free obstacle and another one, which turn it finds to as much.
inline constexpr double free_touching = 1e-9;
/// A pinned point farther behind a plane than this fraction of the box's largest side contradicts the plane.
inline constexpr double pin_slack = 1e-9;
/// position_slack: fraction of the box and of the distance from the origin by which a computed position may be behind a plane.
/// velocity_slack: the same of speeds, ten times as much, because velocities are computed from differences of positions.
inline constexpr double position_slack = 1e-14, velocity_slack = 1e-13;
/// Rounding allowed in a contact constraint of a sample, as a fraction of the box and of distances, or of speeds.
inline constexpr double row_slack = 1e-14;
/// Unit normals count as linearly dependent if the determinant of their Gram matrix is below this value.
inline constexpr double dependent = 1e-14;
/// Fraction of the box's largest side, and of distances in the box, that no computation can distinguish from zero.
inline constexpr double rounding = 2.2e-16;

}  // namespace softffd
