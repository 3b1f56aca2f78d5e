/// Windows of explicit steps in which a stiff body strikes an obstacle or rings on it. Each is run with h and h / 2, and accepted if the
/// final error between the two results is small enough. They end when nothing can be touched for some time, or when the body is quiet.
///
/// The body is quiet if its vibrations cannot move it by an amount that matters: pressed on by a force F, by at most their energy / F.
#pragma once
#include <vector>

#include "impacts/flights.hpp"
#include "kit/landings.hpp"

namespace softffd {

/// Returns the energy that may be damped away from a body that this force [N] presses on [J]; infinite if pins hold the body.
double allowed_loss(const StepContext& context, double pressing);

class Windows {
 public:
  explicit Windows(const Run& run)
      : start_(run.physical), coarse_(run.physical), landings_(run), pushed_(run.physical.exchange.planes.size()) {}
  /// Runs one window and sets the phase that follows.
  StepStatus run(const Beside& at, Flights& flights);

 private:
  bool follow(const Beside& at);
  double flown(const StepContext& context) const;
  StepStatus listen(const Beside& at, Flights& flights, double h, double until, bool decide);

  PhysicalState start_, coarse_;
  Landings landings_;
  Count impacts_ = 0;            ///< number of impacts in the last `listen`
  std::vector<Impulse> pushed_;  ///< impulse on each obstacle before a sub-interval
};

}  // namespace softffd
