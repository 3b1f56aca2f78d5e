/// Forces by which obstacles hold the points that rest on them, to first order in the step.
///
/// The contact rule (contact.hpp) corrects velocities after a half kick. Dashpots couple a point with its neighbours during the kick: they
/// would feel it fall through the obstacle first, an error of first order in every step of a lasting contact, and a body at rest would not
/// stay so. Therefore the kick takes these forces with the others; before the rule decides, the point alone gives back what they would
/// have given it, so that the rule finds the whole reaction, and momentum is what it books.
#pragma once
#include "contact/surface/surface_contact.hpp"

namespace softffd {

class Reactions {
 public:
  Reactions(int points, int planes);

  /// At the opening: of points on an obstacle at t0, from velocities v0 before the kick. step.spring: forces of springs and dashpots there.
  void open(const StepView& step, const Points& v0);
  /// At the closing: of points that were on an obstacle then and still are. v0: velocities before the kick; contact: after its drift.
  void close(const StepView& step, const Contact& contact, const Points& v0);
  /// At either kick, where samples of the surface meet obstacles: of those that touch.
  void hold(const StepView& step, SurfaceContact& surface, const PhysicalState& physical, const Points& v0);
  /// None.
  void clear();

  const Points& forces() const { return forces_; }  ///< on the points [N], (points, 3)
  /// Takes what the forces give their points in half a step out of the velocities again.
  void give_back(const StepView& step, Points& v) const;

 private:
  void kick(const StepView& step, const Points& v0);
  void find(const StepView& step);

  Contact trial_;
  std::vector<char> rested_;  ///< points on an obstacle at the opening
  Exchange nowhere_;
  Points forces_, free_, held_, x_;  ///< velocities after a kick by the forces at its beginning, without and with the rule
};

}  // namespace softffd
