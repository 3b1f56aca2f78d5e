/// Flights of a stiff body beside obstacles (flight/modal_flight.hpp), and what its vibrations will do at the next impact.
#pragma once
#include "flight/modal_flight.hpp"
#include "impacts/beside.hpp"

namespace softffd {

class Flights {
 public:
  Flights(const Lattice& lattice, const Run& run) : flight_(lattice), before_(run.physical) {}

  /// Can the body's motion be carried by its modes now? They are made where the material is new.
  bool rings_about_rest(const StepContext& context);
  /// A flight until something could be touched, where an impact begins, or the end; a contact begins at once where there can be none.
  /// rings: the motion has just been taken apart by `rings_about_rest`.
  StepStatus fly(const Beside& at, bool rings);
  /// Whether nothing can be touched for `least` [s], or until then.
  bool can_fly(const Beside& at, double least, double until);
  /// What the vibrations of two states of this moment differ by.
  struct PhaseError {
    double apart = 0;      ///< places [m]
    double at_impact = 0;  ///< what the next impact will make of it [m]
    double gain = 0;       ///< how many times a difference of positions grows there, by the phase that the vibrations will have
  };
  PhaseError phase_error(const Beside& at, const State& other, const Outlook& ahead);
  bool has_modes(const Body& body) { return flight_.possible(body); }

 private:
  ModalFlight flight_;
  PhysicalState before_;
};

}  // namespace softffd
