/// Leapfrog (velocity Verlet): the central difference of Xia & Wang 2009, eq. (13), written in velocities, which keeps the digits that the
/// recurrence in positions loses to round-off; second order, symplectic without damping, one force evaluation per step.
///
/// Without obstacles, internal damping that is not strong is evaluated once per step, after the forces f, at velocities that are carried
/// on from the middle of the step to its end,
///
///      v1 = v + (v - v0) + (h / 2) (f1 - f0) / m.
///
/// The error of these velocities is of second order and due to the damping alone: a vibration decays as it should. The next step begins
/// with these dashpot forces, a span with the dashpot forces at the velocities themselves. For a vibration that decays with the rate r
/// such steps are stable for omega h <= 2, as without damping, while r h <= 1. Otherwise DampedLeapfrog takes over.
#pragma once
#include <memory>

#include "contact/surface/surface_contact.hpp"
#include "methods/damped_leapfrog.hpp"

namespace softffd {

class Leapfrog final : public Integrator {
 public:
  Leapfrog(int points, int planes);
  Outcome advance(const Model& model, const Drive& drive, const Span& span, Run& run) override;

 private:
  void glide(const Body& body, const Drive& drive, const Span& span, State& state);
  StepStatus run_steps(const Body& body, const Drive& drive, const Span& span, PhysicalState& physical);
  StepStatus open(const StepView& view, PhysicalState& physical);
  StepStatus close(const StepView& view, PhysicalState& physical);
  StepStatus close_and_open(const StepView& last, const StepView& next, PhysicalState& physical);
  void find(const StepView& view, const PhysicalState& physical);
  template <class See>
  void each_found(const See& see);
  bool lasts(Count steps) const;
  StepStatus position_stage(const StepView& view, PhysicalState& physical);
  void recall(const StepView& last, State& state);
  void renew_forces(const StepView& view, State& state);
  void take_dashpots(const Body& body, const State& state, const Points& v);
  double dashpot_loss(const StepView& view, const State& state, const Points& v0) const;

  HalfKicks kicks_;
  Contact contact_;
  PinImpulses pins_;              ///< impulses of pins on their points
  Points before_, start_, next_;  ///< velocities before a half kick and before the step, positions after the drift
  Points force_;                  ///< present outside forces, if they ramp
  Points forces_, carried_;       ///< forces of springs and dashpots, and velocities for the dashpots; empty without dashpots
  Points closed_;                 ///< velocities after the closing kick, for blocks that did not keep them
  Count step_ = 0;
  std::vector<Count> keep_until_;            ///< (blocks) step up to which the state between kicks is kept
  Count any_until_ = -1;                     ///< the largest of these
  std::unique_ptr<SurfaceContact> surface_;  ///< for bodies with samples of their surface
  std::unique_ptr<DampedLeapfrog> damped_;   ///< for bodies with internal damping; most have none
};

}  // namespace softffd
