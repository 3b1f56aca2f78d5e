/// What the propagator is asked for, and what it remembers from one communication step to the next.
#pragma once
#include "model/factored.hpp"
#include "model/method.hpp"
#include "model/state.hpp"

namespace softffd {

/// Why a method took a communication step.
enum class Reason {
  asked,            ///< it was asked for
  contact,          ///< an obstacle is within reach
  damping,          ///< rkn12 was asked for, and the body is damped
  given_step,       ///< automatic with a given internal step
  stability,        ///< the largest stable step is accurate enough: nothing explicit costs less
  least_work,       ///< least work for the tolerance among those tried
  quiet_stiffness,  ///< stiff, and the fast modes are quiet: implicit steps pass them over
  stiff_contact,    ///< an obstacle is within reach of a stiff body
  free_flight       ///< stiff and free, and the fast modes are quiet: rigid motion, and implicit steps for the deformation
};

struct Request {
  Method method = Method::automatic;
  double tolerance = 1e-4;  ///< error aimed at, at the end of the run [m]
  double step = 0;          ///< internal step [s]; 0: by stability and tolerance
  double horizon = 1;       ///< length of the run [s], over which errors add up
  bool jolt = false;        ///< the outside forces have jumped since the last communication step
  bool watch = false;       ///< accumulate dissipated energy and work
  double share = 1;         ///< of the internal step that would be taken otherwise
};

/// Step of a fixed-step method by trial: what h and h / 2 give over a short stretch.
struct Calibration {
  double h = 0;       ///< largest step that keeps the tolerance [s]; 0: not known yet
  double due = 0;     ///< work at which it is due again
  double soon = 0;    ///< the same after a jolt
  double window = 0;  ///< stretch of the last trial [s]: from a much shorter one little is learnt
};

/// Steps through contact, where every stretch is run twice unless experience says that the largest stable step is accurate enough.
struct ContactSteps {
  double h = 0;         ///< of the coarser of the two runs [s]; 0: none yet
  Count free = 0;       ///< stretches without impact that may be run once, at the largest stable step
  Count free_next = 1;  ///< how many after the next success
  Count impact = 0;     ///< the same for stretches with an impact
  Count impact_next = 1;
};

/// Everything the propagator carries on; part of every snapshot.
struct Course {
  Clock clock;
  Points bound_x;     ///< configuration that `bound` belongs to
  double bound = -1;  ///< bound of omega [rad/s]; negative: none yet
  Calibration leapfrog, bm4;
  ContactSteps contact;
  double rkn12 = 0, dop853 = 0, ros34pw2 = 0, floating_frame = 0;  ///< steps of the methods with error control [s]; 0: none yet
  Factored factored;
  Method method = Method::automatic;  ///< that took the last communication step
  Reason reason = Reason::asked;
  Method favourite = Method::automatic;  ///< the last race's winner; automatic: none yet
  Reason favourite_reason = Reason::least_work;
  double work = 0;         ///< done since the start, in evaluations of the spring forces
  double race_due = 0;     ///< work at which the next race is due
  double race_soon = 0;    ///< the same after a jolt
  double race_pause = 1;   ///< its distance, in multiples of a race's own work
  double race_window = 0;  ///< communication step of the last race [s]
  double usual = 0;        ///< length of communication steps of late [s]
  double forecast = 0;     ///< work that the winner should need for what is left of the communication step
  Count steps = 0, rejected = 0;
  Count factors = 0;  ///< matrices factored
};

}  // namespace softffd
