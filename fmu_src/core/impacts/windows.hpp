/// Windows of explicit steps in which a stiff body strikes an obstacle, or rings on it: each is run with h and h / 2, and stands if what
/// the two will differ by at the end of the run is little enough. They end when nothing can be touched for some time, or when it is quiet.
///
/// It is quiet when what the vibrations hold cannot move the body by what matters: pressed on by a force F no further than energy / F.
#pragma once
#include <vector>

#include "impacts/flights.hpp"
#include "kit/landings.hpp"

namespace softffd {

/// Energy that may be damped away of a body that is pressed on with this force [J].
double allowed_loss(const StepContext& context, double pressing);

class Windows {
 public:
  explicit Windows(const Run& run)
      : start_(run.physical), coarse_(run.physical), landings_(run), pushed_(run.physical.exchange.planes.size()) {}
  /// One window; sets the phase that follows.
  StepStatus run(const Beside& at, Flights& flights);

 private:
  bool follow(const Beside& at);
  double flown(const StepContext& context) const;
  StepStatus listen(const Beside& at, Flights& flights, double h, double until, bool decide);

  PhysicalState start_, coarse_;
  Landings landings_;
  Count impacts_ = 0;            ///< of the last listening
  std::vector<Impulse> pushed_;  ///< on each obstacle before a stretch
};

}  // namespace softffd
