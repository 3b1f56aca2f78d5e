/// Windows of explicit steps in which a stiff body strikes an obstacle, or rings on it: each is run with h and h / 2, and stands if what
/// the two will differ by at the end of the run is little enough. They end when nothing can be touched for some time, or when it is quiet.
///
/// It is quiet when what the vibrations hold cannot move the body by what matters: pressed on by a force F no further than energy / F.
#pragma once
#include <vector>

#include "impacts/flights.hpp"

namespace softffd {

/// Energy that may be damped away of a body that is pressed on with this force [J].
double allowed_loss(const StepContext& context, double pressing);

class Windows {
 public:
  explicit Windows(const Run& run) : start_(run.path), coarse_(run.path), accepted_(run.path), pushed_(run.path.exchange.planes.size()) {}
  /// One window; sets the phase that follows.
  StepStatus run(const Beside& at, Flights& flights);

 private:
  void run_sensitivity(const Beside& at, Flights& flights);
  StepStatus listen(const Beside& at, Flights& flights, double h, double until, bool decide);

  Path start_, coarse_, accepted_;
  std::vector<Impulse> pushed_;  ///< on each obstacle before a stretch
};

}  // namespace softffd
