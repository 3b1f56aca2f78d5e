/// Steps of a damped body beside obstacles, or of a pinned one: SDIRK2 with exact contact (contact/implicit/implicit_contact.hpp). Each
/// step is run with h and with two steps of h / 2, and the finer run counts. The difference of the two runs, relative to the bend of the
/// velocities within the step, gives the error of the next steps, which are run once for a while.
///
/// Where constraints of contact change, or something strikes, the error is taken to fall with the first power of the step. The two runs
/// show ringing while a step is no longer than ten radians of it; the energy that a longer step takes shows it beyond. Steps grow by a
/// factor of four at most. Where they would have to be nearly as short as explicit ones, explicit steps take over for a while.
///
/// The error of a step counts for as long as the body remembers it: until its slowest vibration has died away if pins hold the body
/// (kit/slowest_vibration.hpp), else to the end of the run. At the first step of a communication step inputs may jump; that step is no
/// longer than the first step of the communication step before had to be.
#pragma once
#include "kit/slowest_vibration.hpp"
#include "stepping/calibration.hpp"
#include "stepping/step_doubling.hpp"

namespace softffd {

class DampedSteps {
 public:
  /// The explicit steps that take over where implicit steps do not pay, one of the two: leapfrog through contact, or without obstacles.
  struct ExplicitSteps {
    StepDoubling* contact = nullptr;
    Calibrator* free = nullptr;
    bool any() const { return contact || free; }
    /// Work relative to plain steps [1].
    double times() const;
    StepStatus run(Integrators& integrators, const StepContext& context, double until, double most) const;
  };

  DampedSteps(const Lattice& lattice, const Run& run) : slowest_(lattice), start_(run.physical), coarse_(run.physical) {}
  /// others: explicit steps for where implicit steps do not pay; none: implicit steps alone.
  StepStatus run(Integrators& integrators, const StepContext& context, double end, const ExplicitSteps& others);
  /// Length of the shortest implicit step that costs no more than the explicit steps in its place [s].
  static double worth(Integrators& integrators, const StepContext& context, const ExplicitSteps& others);

 private:
  struct Call;
  struct Step {
    StepStatus status;
    Count constraints;  ///< at the end of the step
    bool turned;        ///< a contact stopped, turned round or began to slide in the step
    double bend;
    double lost;   ///< [J]
    double rigid;  ///< way of free obstacles whose slip ends or begins in the step [m]
  };
  struct Forces {
    double difference, largest;
  };
  /// What two runs of a step tell about the finer one.
  struct Judged {
    double error = 0;    ///< [m]
    double lasting = 0;  ///< part of the error that lasts [m]
    double fades = 0;    ///< time in which the rest of the error fades [s]; 0: not at all
    double ratio = 0;    ///< largest ratio of an error to the allowed one [1]
    double over = 0;     ///< part of the error by vibrations that are passed over [m]
    double force = 0;    ///< largest force so far [N]
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
