/// What rounding is allowed where bodies meet planes. Positions carry some 1e-16 of the box and of their distance from the origin.
#pragma once
#include <limits>

namespace softffd {

/// A gap of at most this share of the box's largest side is contact.
inline constexpr double touching = 1e-12;
/// The same of a free obstacle and another one, which turn it finds to as much.
inline constexpr double free_touching = 1e-9;
/// A pinned point further behind a plane than this share of the box's largest side contradicts it.
inline constexpr double pin_slack = 1e-9;
/// Share of the box and the distance from the origin by which a position may be behind a plane in computations; of the speeds, where
/// velocities are computed from a difference of positions, ten times as much.
inline constexpr double position_slack = 1e-14, velocity_slack = 1e-13;
/// What rounding may leave of a row of a sample: of the box and of distances, and of speeds.
inline constexpr double row_slack = 1e-14;
/// Determinant of the Gram matrix of unit normals below which they count as dependent.
inline constexpr double dependent = 1e-14;
/// Share of the box's largest side and of the distances in it that no computation can tell from zero.
inline constexpr double rounding = 2.2e-16;

}  // namespace softffd
