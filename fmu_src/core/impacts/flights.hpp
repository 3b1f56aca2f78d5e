/// Flights of a stiff body beside obstacles (flight/modal_flight.hpp), and the effect of its vibrations on the next impact.
#pragma once
#include "flight/modal_flight.hpp"
#include "impacts/beside.hpp"

namespace softffd {

class Flights {
 public:
  Flights(const Lattice& lattice, const Run& run) : flight_(lattice), before_(run.physical) {}

  /// True if the modes can carry the present motion of the body. Computes the modes if the material has changed.
  bool rings_about_rest(const StepContext& context);
  /// Flies until something could be touched, which begins an impact, or until the end of the communication step. If no flight is possible,
  /// the phase `contact` begins at once. rings: `rings_about_rest` has just decomposed the motion and returned true.
  StepStatus fly(const Beside& at, bool rings);
  /// True if the modes can carry the motion and nothing can be touched for `least` [s], or until the time `until` [s].
  bool can_fly(const Beside& at, double least, double until);
  /// Difference between the vibrations of two states at the present time.
  struct PhaseError {
    double apart = 0;      ///< difference of positions [m]
    double at_impact = 0;  ///< final error that the next impact makes of the difference [m]
    double gain = 0;       ///< factor by which the impact amplifies a position error, through the phase of the vibrations [1]
  };
  PhaseError phase_error(const Beside& at, const State& other, const Outlook& ahead);
  bool has_modes(const Body& body) { return flight_.possible(body); }

 private:
  ModalFlight flight_;
  PhysicalState before_;
};

}  // namespace softffd
