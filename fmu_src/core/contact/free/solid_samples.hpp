/// Solids' own samples, by which a free obstacle meets obstacles that are fixed or in prescribed motion:
///
///      of a sphere      the one point that is nearest to the other obstacle
///      of a cylinder    eight points on each rim, spread evenly from the lowest over the supporting half-space, so that it rolls; and
///                       both ends of the part of its lowest line that lies over the other obstacle's face
///      of a box         its corners; and both ends of the part of each edge that lies over the other obstacle's face
///
/// A sample stands in front of a supporting half-space of the other obstacle, like a sample of the object's surface (tangents.hpp). Of
/// two boxes or cylinders, each has samples in front of the other. Where edges of two boxes cross, only the edge of the free box has
/// samples, because the free box as an obstacle has rounded edges.
#pragma once
#include <optional>

#include "body/samples.hpp"
#include "model/drive.hpp"

namespace softffd {

/// Largest number of samples of a solid; each solid takes this many sample numbers.
constexpr int most_of_solid = 32;

/// Returns the number of samples of a solid.
int samples_of(const PlaneMotion& solid);
/// Returns the solid that an own sample belongs to, from the number of the sample among all (Samples::all).
inline int solid_of(const Samples& samples, int sample) { return (sample - samples.count()) / most_of_solid; }

struct SolidSample {
  Vec3 place;
  Vec3 facing;  ///< point in front of the other obstacle, to which the supporting half-space of the sample belongs
};
/// Returns sample n of a solid in this pose where it meets another obstacle; none if no part of the edge lies over that obstacle.
std::optional<SolidSample> sample_of(const PlaneMotion& solid, const SolidPose& pose, int n, const Plane& other, const SolidPose& its_pose);
/// Returns the gap between a free obstacle and another one at a time in flight: the smallest of the own samples of both [m].
double own_gap(const Plane& free, const Plane& other, double time);
/// True if all free obstacles are off the other obstacles by more than `gap` at this time [m].
bool free_off_others(const std::vector<Plane>& planes, double time, double gap);
/// Returns the coefficient between a free obstacle and another: that of the other; 0 on a guide, for the guide takes what is across it.
double friction_between(const Plane& one, const Plane& other);
/// Returns where the material of a solid that is at `place` in the pose `from` is in the pose `to`.
Vec3 taken_along(const Plane& solid, const SolidPose& from, const Vec3& place, const SolidPose& to);

}  // namespace softffd
