/// Samples of solids' own, by which a free obstacle meets those that are fixed or led:
///
///      of a sphere      the one point that is nearest to what it meets
///      of a cylinder    eight points on each rim, spread evenly from the lowest over the tangent, so that it rolls; and of its lowest line
///                       what lies over the other's face, from end to end
///      of a box         its corners; and of each edge what lies over the other's face, from end to end
///
/// A sample stands before the tangent of the other obstacle, as one of the object's surface does (tangents.hpp). Of two boxes or cylinders
/// each has its samples before the other; where edges of two boxes cross, that of the free one alone, for its own are rounded as an
/// obstacle.
#pragma once
#include <optional>

#include "body/samples.hpp"
#include "model/drive.hpp"

namespace softffd {

/// Samples that a solid may have; each has this many numbers.
constexpr int most_of_solid = 32;

/// Number of samples of a solid.
int samples_of(const PlaneMotion& solid);
/// Whose own sample it is, by its number among all (Samples::all).
inline int solid_of(const Samples& samples, int sample) { return (sample - samples.count()) / most_of_solid; }

struct SolidSample {
  Vec3 place;
  Vec3 facing;  ///< the point in front of the other obstacle whose tangent the sample stands before
};
/// Sample n of a solid in this pose, where it meets another obstacle; none where nothing of the edge lies over it.
std::optional<SolidSample> sample_of(const PlaneMotion& solid, const SolidPose& pose, int n, const Plane& other, const SolidPose& its_pose);
/// Gap between a free obstacle and another one at a time in flight: the least of the own samples of both [m].
double own_gap(const Plane& free, const Plane& other, double time);
/// Whether free obstacles are off all others by this much then [m].
bool free_off_others(const std::vector<Plane>& planes, double time, double gap);
/// Coefficient between a free obstacle and another: of that one; of a body on a guide none, for the guide takes what is across it.
double friction_between(const Plane& one, const Plane& other);
/// Where material of a solid that was at this place in one pose is in another.
Vec3 taken_along(const Plane& solid, const SolidPose& from, const Vec3& place, const SolidPose& to);

}  // namespace softffd
