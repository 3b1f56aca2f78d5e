/// Solid obstacles, as samples of the surface meet them: each sample near a solid stands before a supporting half-space of its own, its
/// tangent.
///
///            .  n      The half-space behind the tangent at the point of the solid closest to the sample contains the whole solid,
///         s  . /       which is convex: a sample that ends a step in front of it is outside. The half-space is found for the sample's
///      ----.-'----     place at the start of the step, in the frame of the solid, and moves with the solid from there: a sample that
///       ( solid )      starts before one side of a thin solid never ends behind the other. Velocities at the end of the step use the
///                      half-spaces there, so that each half of an impulse has the direction of one end of the step.
///
/// A solid is a sphere, a cylinder with flat ends or a box, about the point of its pose; the axis of a cylinder is the normal of the
/// pose. The supporting half-space of a box is at a face, an edge or a corner. A sample that starts before a face stays in front of the
/// whole plane of that face until the step ends, and is past an edge in the next step only.
#pragma once
#include <vector>

#include "body/samples.hpp"
#include "contact/free/solid_samples.hpp"

namespace softffd {

/// Returns the supporting half-space of the solid in this pose at the point closest to x; if x is inside, the one in which x is least
/// deep. It moves with the solid.
HalfSpace tangent(const Plane& solid, const SolidPose& pose, const Vec3& x);

/// Returns the least gap of the points above the supporting half-space closest to their mean [m]: no sample is nearer to the solid.
double gap_between(const Plane& solid, const SolidPose& pose, const Points& x);

/// Returns the half-space of an obstacle that faces x, whether the obstacle is a solid or a half-space.
HalfSpace facing_half_space(const Plane& obstacle, double time, const Vec3& x);
HalfSpace facing_half_space(const Plane& obstacle, const SolidPose& pose, const Vec3& x);

struct Tangent {
  int obstacle, sample;
  HalfSpace start, middle, end;  ///< of the step
  double friction;               ///< coefficient
  // if the sample is a solid's own:
  int solid = -1;            ///< its solid; -1: the sample is the object's
  Vec3 place{}, velocity{};  ///< at the start
  Vec3 flown{};              ///< the same material point at the end, without contact
  Vec3 nearest{};            ///< the sample at the end; not the same material point if the solid rolls
};

class Tangents {
 public:
  Tangents(const Samples& samples, double length) : samples_(samples), length_(length) {}

  /// Finds the tangents for samples that can come to a solid between t0 and t1, if no control point moves by more than `way` [m]. Sorted
  /// by obstacle and sample; solids' own samples come last. x0: control points at t0.
  void find(const Drive& around, double t0, double t1, const Points& x0, double way);
  /// Finds the tangents for solids' own samples alone, at a time [s].
  void find_own(const Drive& around, double time);
  /// Moves free obstacles, with their states in `free`, out of others by these tangents. Sets `moved` if any has moved.
  StepStatus move_out(const Drive& around, double time, std::vector<FreeState>& free, bool& moved);
  void forget_own();
  void forget() { found_.clear(); }
  const std::vector<Tangent>& found() const { return found_; }
  /// Returns the index of the tangent of this sample at this obstacle; -1: there is none.
  int index(int obstacle, int sample) const;
  /// Returns the number of a solid's own sample among the samples of that solid.
  int number_of(const Tangent& own) const { return own.sample - samples_.count() - most_of_solid * own.solid; }
  /// Finds the tangents of solids' own samples anew, for the obstacles at a time [s].
  void renew_own(const Drive& around, double time);
  /// Returns the gap of a solid's own sample, with the obstacles in these poses [m].
  double gap_of(const Drive& around, const Tangent& own, const SolidPose& of_solid, const SolidPose& of_obstacle) const;
  /// Returns by how much any sample can have moved at most [m].
  double way(const Points& from, const Points& to);
  /// True if the tangents found suffice for this way [m].
  bool covers(double way) const { return way <= way_; }

 private:
  /// What is known of an obstacle since its samples were looked at last.
  struct Known {
    double least = -1;    ///< no sample was nearer [m]
    double reserve = -1;  ///< samples with gaps up to it are in the list [m]; negative: no list
    std::vector<int> near;
    Points x;
    SolidPose pose;
  };
  void find_between(const Drive& around, double t0, double t1, double way);
  /// The poses of an obstacle during the step.
  struct StepPoses {
    int number;
    const Plane* plane;
    SolidPose start, middle, end;
  };
  static StepPoses step_poses(const Drive& around, double t0, double t1, int obstacle);
  void meet(const StepPoses& solid, const StepPoses& obstacle, double reach);
  std::optional<Tangent> meeting(const StepPoses& solid, int n, const StepPoses& obstacle, double reach) const;
  double way_since(const Known& known, const Points& x, const SolidPose& pose, const Plane& solid);
  void list(const Plane& solid, const SolidPose& pose, const Points& x0, double reach, Known& known);

  const Samples& samples_;
  double length_;
  double way_ = 0;
  std::vector<Known> known_;  ///< of each obstacle
  std::vector<Tangent> found_;
  Points room_, move_;
};

}  // namespace softffd
