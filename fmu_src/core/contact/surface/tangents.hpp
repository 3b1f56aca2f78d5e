/// Solid obstacles, as samples of the surface meet them: each sample near one stands before a half-space of its own.
///
///            .  n      the half-space behind the tangent at the point of the solid that is closest to the sample holds the whole solid,
///         s  . /       which is convex: a sample that ends a step in front of it is outside. It is taken where the sample is when
///      ----.-'----     the step begins, in the frame of the solid, and goes with the solid from there: a sample that starts
///       ( solid )      before one side of a thin solid never ends behind the other. Velocities at the end of the step go by the tangents
///                      there, so that half of an impulse has the direction of either end.
///
/// A solid is a sphere, a cylinder with flat ends or a box, about the point of its pose; a cylinder's axis is the pose's normal. Tangents
/// of a box go by a face, an edge or a corner: a sample that starts before a face stays in front of all of that face's plane until the step
/// ends, and is past an edge for the next step only.
#pragma once
#include <vector>

#include "body/samples.hpp"
#include "contact/free/solid_samples.hpp"

namespace softffd {

/// The half-space of a solid in this pose that is closest to x, or furthest in front of it where x is inside; it moves as the solid does.
HalfSpace tangent(const Plane& solid, const SolidPose& pose, const Vec3& x);

/// How far all points are in front of the tangent that is nearest to their middle [m]: no sample is nearer to the solid.
double gap_between(const Plane& solid, const SolidPose& pose, const Points& x);

/// The half-space of an obstacle, be it a solid or not, that faces x.
HalfSpace facing_half_space(const Plane& obstacle, double time, const Vec3& x);
HalfSpace facing_half_space(const Plane& obstacle, const SolidPose& pose, const Vec3& x);

struct Tangent {
  int obstacle, sample;
  HalfSpace start, middle, end;  ///< of the step
  double friction;               ///< coefficient
  // where the sample is a solid's own:
  int solid = -1;            ///< whose; -1: it is the object's
  Vec3 place{}, velocity{};  ///< at the start
  Vec3 flown{};              ///< the same material at the end, without contact
  Vec3 nearest{};            ///< the sample there; not the same material where the solid rolls
};

class Tangents {
 public:
  Tangents(const Samples& samples, double length) : samples_(samples), length_(length) {}

  /// Of the samples that can come to a solid between t0 and t1, where no control point moves by more than `way` [m]; by obstacle and
  /// sample; solids' own ones last. x0: control points at t0.
  void find(const Drive& around, double t0, double t1, const Points& x0, double way);
  /// Those of solids' own samples alone, at a time.
  void find_own(const Drive& around, double time);
  /// Moves free obstacles out of others by these, each with its state in `free`. Sets `moved` if there was any.
  StepStatus move_out(const Drive& around, double time, std::vector<FreeState>& free, bool& moved);
  void forget_own();
  void forget() { found_.clear(); }
  const std::vector<Tangent>& found() const { return found_; }
  /// Where among them that of this sample at this obstacle is; -1: there is none.
  int index(int obstacle, int sample) const;
  /// Number of the solid's own sample in all of its samples.
  int number_of(const Tangent& own) const { return own.sample - samples_.count() - most_of_solid * own.solid; }
  /// Those of solids' own samples are from now on where the obstacles are at a time.
  void renew_own(const Drive& around, double time);
  /// The gap of a solid's own sample, with obstacles in these poses.
  double gap_of(const Drive& around, const Tangent& own, const SolidPose& of_solid, const SolidPose& of_obstacle) const;
  /// By which any sample can have moved [m].
  double way(const Points& from, const Points& to);
  /// Are the tangents those of such a way too?
  bool covers(double way) const { return way <= way_; }

 private:
  /// Of an obstacle, when its samples were looked at last.
  struct Known {
    double least = -1;    ///< no sample was nearer [m]
    double reserve = -1;  ///< those within it are in the list; negative: there is none
    std::vector<int> near;
    Points x;
    SolidPose pose;
  };
  void find_between(const Drive& around, double t0, double t1, double way);
  /// Of an obstacle in the course of the step.
  struct ControllerState {
    int number;
    const Plane* plane;
    SolidPose start, middle, end;
  };
  static ControllerState control(const Drive& around, double t0, double t1, int obstacle);
  void meet(const ControllerState& solid, const ControllerState& obstacle, double reach);
  std::optional<Tangent> meeting(const ControllerState& solid, int n, const ControllerState& obstacle, double reach) const;
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
