/// Steps of a stiff body at rest on obstacles or sliding on them: backward Euler with exact contact, its rigid motion by the mean of the
/// velocities before and after, so that sliding is exact in steps of any length, and without creep where the body sticks. Each is run with
/// h and with two of h / 2, unless a number of them has shown that nothing changes, and ends where a contact's state changes
/// (contact_events.hpp); what it loses beyond damping and friction must be little.
#pragma once
#include <vector>

#include "impacts/beside.hpp"
#include "impacts/contact_events.hpp"

namespace softffd {

class RestSteps {
 public:
  explicit RestSteps(const Run& run);
  /// One step, or none where the phase has to be another: sets it.
  StepStatus run(const Beside& at);

 private:
  struct Step {
    StepStatus status = StepStatus::ok;
    double lost = 0, pressing = 0;  ///< [J], [N]
    Slip slip{};
  };
  StepStatus settle(const Beside& at);
  double allowed(const StepContext& context, double h) const;
  bool tips(const StepContext& context) const;
  bool step_once(const Beside& at);
  StepStatus step_twice(const Beside& at, double next);
  bool doubted(const Beside& at, double h);
  Step step(const Beside& at, double until, bool settling = false);
  Step step_before_event(const Beside& at, double& next, double allowed, ContactEvent& event);
  Outcome take_in_frame(const Beside& at, const Vec3& acceleration, const Span& span);
  bool keep_in_front(const StepContext& context);

  PhysicalState start_, before_, coarse_;
  std::vector<HalfSpace> obstacles_;
  Points x_;
  Drive drive_;  ///< as the accelerated observer has it
};

}  // namespace softffd
