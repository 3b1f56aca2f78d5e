/// Steps of a stiff body at rest on obstacles or sliding on them, by backward Euler with exact contact. The rigid motion goes by the mean
/// of the velocities before and after, so that sliding is exact in steps of any length, and a sticking body does not creep. Each step is
/// run with h and with two of h / 2, unless a number of steps has shown that nothing changes, and ends where a contact's state changes
/// (contact_events.hpp). The energy that a step loses beyond damping and friction must be small.
#pragma once
#include <vector>

#include "impacts/beside.hpp"
#include "impacts/contact_events.hpp"

namespace softffd {

class RestSteps {
 public:
  explicit RestSteps(const Run& run);
  /// Takes one step, or takes none and sets the phase if another phase is needed.
  StepStatus run(const Beside& at);

 private:
  struct Step {
    StepStatus status = StepStatus::ok;
    double lost = 0, pressing = 0;  ///< energy lost beyond drag and friction [J]; force on the obstacles [N]
    Slip slip{};
  };
  StepStatus settle(const Beside& at);
  double allowed(const StepContext& context, double h) const;
  void lose(const StepContext& context, double h, double lost);
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
  Drive drive_;  ///< the drive as an accelerated observer sees it
};

}  // namespace softffd
