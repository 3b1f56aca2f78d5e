/// Leapfrog (velocity Verlet): the central difference of Xia & Wang 2009, eq. (13), written in velocities, which keeps the digits that the
/// recurrence in positions loses to round-off; second order, symplectic without damping, one force evaluation per step.
///
/// Weak internal damping is evaluated with the forces f, once a step, at velocities carried on from its middle to its end,
///
///      v1 = v + (v - v0),      and where there are no obstacles      + (h / 2) (f1 - f0) / m,
///
/// which err by what is of second order; with the last term by the damping alone, so that a vibration decays as it should. In contact
/// they are those of the motion, whatever obstacles exert, and at rest exactly. The next step begins with these dashpots; at the beginning
/// of a span and after a landing they are taken at the velocities themselves. Of a vibration that decays with the rate r such steps are
/// stable while (omega h / 2)^2 + r h <= 1, where the polynomial of a step has a root at -1; with the last term while omega h <= 2 and
/// r h <= 1. Stronger damping is DampedLeapfrog's.
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
  StepStatus run_steps(const Body& body, const Drive& drive, const Span& span, Path& path);
  StepStatus open(const StepView& view, Path& path);
  StepStatus close(const StepView& view, Path& path, bool last);
  StepStatus close_and_open(const StepView& last, const StepView& next, Path& path);
  void find(const StepView& view, const Path& path);
  template <class See>
  void each_found(const See& see);
  bool lasts(Count steps) const;
  StepStatus position_stage(const StepView& view, Path& path);
  void recall(const StepView& last, State& state);
  void renew_forces(const StepView& view, State& state, bool last);
  void take_dashpots(const Body& body, const State& state, const Points& v);
  double dashpot_loss(const StepView& view, const State& state, const Points& v0) const;
  Count impacts() const { return surface_ ? surface_->impacts() : contact_.impacts(); }

  HalfKicks kicks_;
  Contact contact_;
  Points before_, start_, next_;  ///< velocities before a half kick and before the step, positions after the drift
  Points force_;                  ///< outside forces now, where they ramp
  Points forces_, carried_;       ///< of the energies with their dashpots, and the velocities that these go by; empty without
  Points closed_;                 ///< velocities after the closing kick, where they were not kept
  Count step_ = 0;
  std::vector<Count> keep_until_;            ///< (blocks) step up to which what lies between kicks is kept
  Count any_until_ = -1;                     ///< of any
  bool landed_ = false;                      ///< a point came onto an obstacle in this step
  std::unique_ptr<SurfaceContact> surface_;  ///< for bodies with samples of their surface
  std::unique_ptr<DampedLeapfrog> damped_;   ///< for bodies with internal damping; most have none
};

}  // namespace softffd
