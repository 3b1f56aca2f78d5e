/// Leapfrog of a body with internal damping: half kicks with the dashpots in them (body/damped_kick.hpp) around a drift; second order for
/// any damping, stable for the same steps as without. Its fixed points are those of the equations: rest, and rest on obstacles.
///
/// A body that turns drifts along its tangents, so that every spring grows by the square of the angle; the springs' own forces bring it
/// back at the next kick, unless dashpots hold it. The dashpots therefore go by the mean rate over the drift, the opening kick by that
/// ahead, the closing one by that behind,
///
///      (|d + h w| - |d|) / h  =  w along d  +  h/2 (w across d)^2 / |d|:
///
/// the difference cancels to second order in h, and where dashpots are strong a body that turns keeps its size.
#pragma once
#include <memory>

#include "body/damped_kick.hpp"
#include "contact/reactions.hpp"
#include "methods/integrator.hpp"

namespace softffd {

class DampedLeapfrog {
 public:
  DampedLeapfrog(int points, int planes);
  Outcome advance(const Model& model, const Drive& drive, const Span& span, Run& run);

 private:
  StepStatus step(const Body& body, const Drive& drive, const Span& span, Count i, PhysicalState& physical);
  StepStatus open(const StepView& view, PhysicalState& physical);
  StepStatus close(const StepView& view, PhysicalState& physical);
  /// The forces at the beginning of a kick, of dashpots by these velocities. drift: the time of the drift after it, or less than 0 of the
  /// one before it.
  void prepare_kick(const StepView& view, const State& state, const Points& rates, double drift);
  bool is_held(const PhysicalState& physical) const;
  /// From before_, with the reactions of obstacles where there are any.
  Count impacts() const { return surface_ ? surface_->impacts() : contact_.impacts(); }
  void kick(const StepView& view, State& state, bool held, bool drifted, Exchange& exchange);

  HalfKicks masses_;  ///< what the contact rule asks of kicks
  DampedKick kick_;
  Contact contact_;
  PinImpulses pins_;  ///< of what pins give their points
  Reactions reactions_;
  std::unique_ptr<SurfaceContact> surface_;  ///< for bodies with samples of their surface
  bool lands_ = false;                       ///< a point comes onto an obstacle in this step
  bool resolved_ = false;                    ///< kicks are so short that the forces at their beginning tell the reactions
  Points before_, middle_, next_;            ///< velocities before a half kick and after the drift, positions after it
  Points drift_;                             ///< by which points have moved in it
  Points kicked_, rates_;                    ///< velocities after a half kick with the reactions; those that the dashpots go by
  Points force_, inner_, acting_;            ///< outside forces now; forces of springs and dashpots; outside forces with the reactions
};

}  // namespace softffd
