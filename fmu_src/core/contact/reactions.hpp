/// Reaction forces of obstacles on the points that rest on them, to first order in the step.
///
/// The contact rule (contact.hpp) corrects velocities after a half kick. Dashpots couple a point with its neighbours during the kick: the
/// neighbours would feel the point fall through the obstacle first, an error of first order in every step of a lasting contact, and a
/// body at rest would not stay at rest. Therefore the kick includes these reaction forces. Before the contact rule is applied, each point
/// gives back the velocity that its own reaction force added, so that the rule finds the whole reaction and books the exact momentum.
#pragma once
#include "contact/surface/surface_contact.hpp"

namespace softffd {

class Reactions {
 public:
  Reactions(int points, int planes);

  /// Computes the forces in the opening kick, on points that are on an obstacle at t0. v0: velocities before the kick; step.spring:
  /// forces of springs and dashpots at v0.
  void open(const StepView& step, const Points& v0);
  /// The same for the closing kick, on points that were on an obstacle at t0 and still are. v0: as above; contact: after its drift.
  void close(const StepView& step, const Contact& contact, const Points& v0);
  /// Computes the forces in either kick from the samples that touch, if obstacles meet samples of the surface.
  void hold(const StepView& step, SurfaceContact& surface, const PhysicalState& physical, const Points& v0);
  /// Sets all forces to 0.
  void clear();

  const Points& forces() const { return forces_; }  ///< on the points [N], (points, 3)
  /// Subtracts from the velocities what the forces have added to their points in half a step.
  void give_back(const StepView& step, Points& v) const;

 private:
  void kick(const StepView& step, const Points& v0);
  void find(const StepView& step);

  Contact trial_;
  std::vector<char> rested_;  ///< points on an obstacle at the opening
  Exchange nowhere_;
  Points forces_, free_, held_, x_;  ///< free_, held_: velocities after a kick by the forces at its start, without and with the rule
};

}  // namespace softffd
