/// Leapfrog for a body with internal damping: half kicks that contain the dashpots (body/damped_kick.hpp) around a drift. It is of second
/// order for any damping and stable for the same steps as without. Its fixed points are those of the equations: rest, also on obstacles.
///
/// The points of a turning body drift along tangents, so that every spring grows by the square of the angle. The forces of the springs
/// bring the length back at the next kick, unless dashpots hold it. The dashpots therefore use the mean rate of length over a drift, the
/// opening kick over the drift ahead, the closing kick over the drift behind,
///
///      (|d + h w| - |d|) / h  =  w along d  +  h/2 (w across d)^2 / |d|:
///
/// the difference cancels to second order in h, and a turning body keeps its size even where dashpots are strong.
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
  /// Longest step whose kicks contain the reactions of obstacles [s]. In longer steps the error of a lasting contact is of first order.
  static double longest_with_reactions(const Body& body);

 private:
  StepStatus step(const Body& body, const Drive& drive, const Span& span, Count i, PhysicalState& physical);
  StepStatus open(const StepView& view, PhysicalState& physical);
  StepStatus close(const StepView& view, PhysicalState& physical);
  /// Computes the forces at the beginning of a kick, with the dashpots at velocities `rates`. drift: duration of the drift that follows
  /// the kick [s], or minus the duration of the drift before the kick.
  void prepare_kick(const StepView& view, const State& state, const Points& rates, double drift);
  bool is_held(const PhysicalState& physical) const;
  Count impacts() const { return surface_ ? surface_->impacts() : contact_.impacts(); }
  /// Half kick from before_, with the reactions of obstacles if `held`. drifted: the kick follows the drift.
  void kick(const StepView& view, State& state, bool held, bool drifted, Exchange& exchange);

  HalfKicks masses_;  ///< masses by which the contact rule converts velocities to impulses
  DampedKick kick_;
  Contact contact_;
  PinImpulses pins_;  ///< impulses of pins on their points
  Reactions reactions_;
  std::unique_ptr<SurfaceContact> surface_;  ///< for bodies with samples of their surface
  bool lands_ = false;                       ///< a point lands on an obstacle in this step
  bool resolved_ = false;                    ///< kicks are short enough that the forces at their beginning determine the reactions
  Points before_, middle_, next_;            ///< velocities before a half kick and after the drift, positions after it
  Points drift_;                             ///< displacements in the drift [m]
  Points kicked_, rates_;                    ///< velocities after a half kick with the reactions; velocities for the dashpots
  Points force_, inner_, acting_;            ///< outside forces now; forces of springs and dashpots; outside forces with the reactions
};

}  // namespace softffd
