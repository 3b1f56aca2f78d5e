/// A damped body beside obstacles, or one that is pinned: SDIRK2 with exact contact (contact/implicit/implicit_contact.hpp), each step with
/// h and with two of h / 2, and the finer run counts. What the two differ by, in the bend of the velocities within the step, gives the
/// error of the next steps, which are run once for a while.
///
/// Where constraints of contact change, or something strikes, the error falls with the first power of the step: it is taken so. What rings
/// is seen by the two runs while a step is no longer than ten radians of it, and beyond by the energy that the step takes; steps grow by a
/// factor of four at most. Where they would have to be nearly as short as explicit ones, these take over for a while.
///
/// What a step errs by counts for as long as the body remembers it: held by pins, until its slowest vibration has died away
/// (kit/slowest_vibration.hpp); else to the end of the run. The first step of a communication step, at which inputs may jump, is no
/// longer than the one before had to be.
#pragma once
#include "kit/slowest_vibration.hpp"
#include "stepping/calibration.hpp"
#include "stepping/step_doubling.hpp"

namespace softffd {

class DampedSteps {
 public:
  /// What takes over where implicit steps do not pay, one of the two: leapfrog through contact, or without obstacles.
  struct ExplicitSteps {
    StepDoubling* contact = nullptr;
    Calibrator* free = nullptr;
    bool any() const { return contact || free; }
    /// Work beside that of plain steps [1].
    double times() const;
    StepStatus run(Integrators& integrators, const StepContext& context, double until, double most) const;
  };

  DampedSteps(const Lattice& lattice, const Run& run) : slowest_(lattice), start_(run.physical), coarse_(run.physical) {}
  /// others: for where implicit steps do not pay; none: never.
  StepStatus run(Integrators& integrators, const StepContext& context, double end, const ExplicitSteps& others);
  /// Shortest implicit step that costs no more than explicit ones in its place [s].
  static double worth(Integrators& integrators, const StepContext& context, const ExplicitSteps& others);

 private:
  struct Call;
  struct Step {
    StepStatus status;
    Count constraints;  ///< at its end
    bool turned;        ///< a contact stopped, turned round or began to slide in it
    double bend;
    double lost;   ///< [J]
    double rigid;  ///< way of free obstacles that ends or begins in it [m]
  };
  struct Forces {
    double difference, largest;
  };
  /// What two runs of a step say of the finer one.
  struct Judged {
    double error = 0;    ///< [m]
    double lasting = 0;  ///< part of it [m]
    double fades = 0;    ///< in which the rest does [s]; 0: not at all
    double ratio = 0;    ///< of errors in what is allowed, the worst [1]
    double over = 0;     ///< part of the error that is of vibrations passed over [m]
    double force = 0;    ///< largest so far [N]
    Count constraints = 0;
    bool steady = false;  ///< no constraint changed
    double growth() const;
  };
  static void book(const Call& call, double h, double error, double lasting);
  Step take(const Call& call, double until, bool again = false);
  StepStatus step(const Call& call, double until);
  Judged run_halves(const Call& call, double until, double allowed, const Step& coarse);
  static void accept(const Call& call, double h, double allowed, double bend, const Judged& judged);
  Forces compare_forces(const Call& call) const;
  double passed_over(const Call& call, double h, double lost) const;
  StepStatus take_explicit(const Call& call);

  double memory(const StepContext& context);

  SlowestVibration slowest_;
  PhysicalState start_, coarse_;
};

}  // namespace softffd
