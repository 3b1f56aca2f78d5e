/// Everything that stepping changes. A copy of a Run is a snapshot: it continues exactly as the original does.
///
///      PhysicalState     the motion of the body and its reactions; a rejected sub-interval restores it
///      ControllerState   step sizes, trials and spent work; a rejected sub-interval keeps it
///      EnergyAccount     compares the energy of the body with the work done on it (watch/energy_watch.hpp)
#pragma once
#include <algorithm>

#include "machine/elementary.hpp"
#include "model/exchange.hpp"
#include "model/state.hpp"

namespace softffd {

/// Why a method took a communication step.
enum class Reason {
  asked,            ///< it was asked for
  contact,          ///< an obstacle is within reach
  damping,          ///< the method asked for cannot follow the damping
  given_step,       ///< automatic with a given internal step
  stability,        ///< the largest stable step is accurate enough: nothing explicit costs less
  least_work,       ///< least work for the tolerance among those tried
  quiet_stiffness,  ///< stiff, and the fast modes are quiet: implicit steps pass them over
  stiff_contact,    ///< an obstacle is within reach of a stiff body
  damped_contact,   ///< an obstacle is within reach of a body with internal damping
  free_flight,      ///< stiff and free, and the fast modes are quiet: rigid motion, and implicit steps for the deformation
  impact,           ///< a stiff body strikes an obstacle, or rings on one
  ringing_flight    ///< a stiff body flies beside an obstacle: its modes carry what vibrates
};
constexpr Reason last(Reason) { return Reason::ringing_flight; }

/// Step of a fixed-step method by trial: what h and h / 2 give over a short stretch.
struct Calibration {
  double h = 0;       ///< largest step that keeps the tolerance [s]; 0: not known yet
  double due = 0;     ///< work at which it is due again
  double soon = 0;    ///< the same after a jolt
  double window = 0;  ///< stretch of the last trial [s]: from a much shorter one little is learnt

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.h, s.due, s.soon, s.window);
  }
};
static_assert(visits_every_field<Calibration>);

/// What two runs of a stretch differ by at the end of the run, or a sum of that [m]. Most stretches err now this way, now that way: sizes
/// add as lengths of vectors at right angles do. What errs the same way again and again, as rolling does, is seen by its direction.
struct FinalError {
  double size = 0;
  double lag = 0;                                  ///< the same if pins hold the body: phases of its vibrations always fall behind
  Vec3 shift = Vec3::Zero(), turn = Vec3::Zero();  ///< else, of the body as a whole; turned, of its outermost point

  double largest() const { return std::max({size, lag, shift.norm(), turn.norm()}); }
  FinalError times(double factor) const { return {factor * size, factor * lag, factor * shift, factor * turn}; }
  void add(const FinalError& of) { *this = {hypotenuse(size, of.size), lag + of.lag, shift + of.shift, turn + of.turn}; }
  /// To what stretches like the last one leave: directions that change cancel.
  void learn(const FinalError& last) { *this = {last.size, last.lag, 0.5 * (shift + last.shift), 0.5 * (turn + last.turn)}; }

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.size, s.lag, s.shift, s.turn);
  }
};
static_assert(visits_every_field<FinalError>);

/// A stretch that was run twice.
struct TriedStretch {
  double h = 0;         ///< step of the coarser run [s]; 0: none
  double error = 0;     ///< at the end of the run, forecast [m]
  bool impact = false;  ///< something came onto an obstacle in it

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.h, s.error, s.impact);
  }
};
static_assert(visits_every_field<TriedStretch>);

/// Error that shorter steps do not make smaller.
struct ErrorFloor {
  double error = 0;  ///< at the end of the run, forecast [m]
  Count left = 0;    ///< stretches that may have it before shorter steps are tried again
  Count next = 1;    ///< how many after the next time that they are tried in vain

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.error, s.left, s.next);
  }
};
static_assert(visits_every_field<ErrorFloor>);

/// Steps through contact, where every stretch is run twice unless experience says that the largest stable step is accurate enough.
struct ContactSteps {
  double h = 0;         ///< of the coarser of the two runs [s]; 0: none yet
  Count free = 0;       ///< stretches without impact that may be run once, at the largest stable step
  Count free_next = 1;  ///< how many after the next success
  Count impact = 0;     ///< the same for stretches with an impact
  Count impact_next = 1;
  Count seen = 0;                        ///< steps since a whole stretch was seen
  double largest = 0, largest_seen = 0;  ///< error relative to the square of the step [m/s2]: since then, and in the whole stretch before
  FinalError final_error{};              ///< by a stretch at the step of the coarser run
  TriedStretch tried{};                  ///< the last that shorter steps are to mend
  ErrorFloor floor{};

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.h, s.free, s.free_next, s.impact, s.impact_next, s.seen, s.largest, s.largest_seen, s.final_error, s.tried, s.floor);
  }
};
static_assert(visits_every_field<ContactSteps>);

/// By how much places may be off, as time goes.
struct Drift {
  double place = 0, speed = 0;  ///< at this time [m, m/s]
  double time = 0;              ///< [s]

  /// lasting: how long a velocity lasts at most [s].
  double at(double now, double lasting) const { return place + speed * std::clamp(now - time, 0.0, lasting); }

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.place, s.speed, s.time);
  }
};
static_assert(visits_every_field<Drift>);

/// The motion of a body that began a landing as far off as this one may be: by what they differ the error is known that landings make of
/// errors (kit/landings.hpp). Empty without obstacles.
struct Neighbour {
  Points x, v;                    ///< while it is integrated beside the run, its own; else its last difference from the run [m, m/s]
  std::vector<FreeState> free{};  ///< bodies, likewise
  bool follows = false;           ///< takes them
  bool landed = false;            ///< has come onto an obstacle since it began to
  double began = 0, impact = 0;   ///< times at which it last began to, and of the run's last impact [s]
  Drift off{};                    ///< its distance from the run

  /// What it was off stands, and it no longer goes on from there.
  void forget() {
    x.setZero();
    v.setZero();
    free.assign(free.size(), {});
    follows = false;
  }

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.x, s.v, s.free, s.follows, s.landed, s.began, s.impact, s.off);
  }
};
static_assert(visits_every_field<Neighbour>);

/// Where a stiff body stands with the obstacles (impacts/impacts.hpp).
enum class Phase {
  flight,   ///< nothing can be touched
  impact,   ///< near an obstacle after a flight: explicit steps of the vibrations' size
  contact,  ///< the same, for some time already
  rest      ///< pressed on, and so quiet that long implicit steps lose nothing that matters
};
constexpr Phase last(Phase) { return Phase::rest; }

struct StiffContact {
  Phase phase = Phase::flight;
  bool settling = false;  ///< the next step at rest is the first
  Count looks = 0;        ///< at an impact, since the listening began
  double impulse = 0;     ///< on the obstacles since then [N s]
  double listened = 0;    ///< length of it [s]
  double loudest = 0;     ///< largest kinetic energy of deformation since then [J]; with pins the size of the vibrations [m]
  double pressing = 0;    ///< force on the obstacles, when last known [N]
  double since = 0;       ///< begin of the impact [s]
  Count doubts = 0;       ///< how often rest was left too early to pay
  Count trust = 0;        ///< windows that may be run once
  Count next_trust = 1;   ///< how many after the next success
  FinalError trusted{};   ///< by one, as of the last that was run twice
  Count rest_trust = 0, next_rest_trust = 1;  ///< the same for steps at rest
  double step = 0;                            ///< at rest [s]; 0: none yet
  double unknown = 0;                         ///< that the vibrations' unknown phases at impacts may have added [m]
  double flown = 0;                           ///< what vibrations in flight may be off by [m]; 0: not known

  /// Begins anew in this phase; what it has cost stays.
  void begin(Phase next) { *this = {.phase = next, .doubts = next == Phase::flight ? 0 : doubts, .unknown = unknown, .flown = flown}; }

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.phase, s.settling, s.looks, s.impulse, s.listened, s.loudest, s.pressing, s.since, s.doubts, s.trust, s.next_trust,
                  s.trusted, s.rest_trust, s.next_rest_trust, s.step, s.unknown, s.flown);
  }
};
static_assert(visits_every_field<StiffContact>);

/// What trial runs between methods have shown, and when the next one is due, in work done by then.
struct TrialRecord {
  Method winner = Method::automatic;  ///< automatic: none yet
  Reason reason = Reason::least_work;
  double due = 0;       ///< work at which the next one is due
  double soon = 0;      ///< the same after a jolt
  double pause = 1;     ///< its distance, in multiples of the trial runs' own work
  double window = 0;    ///< communication step of the last one [s]
  double forecast = 0;  ///< work that the winner should need for what is left of the communication step

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.winner, s.reason, s.due, s.soon, s.pause, s.window, s.forecast);
  }
};
static_assert(visits_every_field<TrialRecord>);

/// Implicit steps of second order of a damped body, beside obstacles or pinned (stepping/damped_steps.hpp).
struct DampedRecord {
  double h = 0;               ///< wanted [s]; 0: none yet
  Count trust = 0;            ///< steps that may be run once
  Count next_trust = 1;       ///< how many after the next success
  double share = 1;           ///< error of a step in the bend of its velocities, as of the last one that was run twice [1]
  double lasting = 1;         ///< part of that error that lasts [1]
  double fades = 0;           ///< in which the rest of it does, where no pin holds the body [s]; 0: not at all
  Count constraints = 0;      ///< of contact, at the end of the last step
  Count doubts = 0;           ///< how often explicit steps had to take over, one time after the other
  double rate = 0;            ///< work of explicit steps in a second, as of the last that took over; 0: not known
  double explicit_until = 0;  ///< time until which they have, the last time [s]
  double force = 0;           ///< largest on an obstacle or a pin so far, as mean of a step [N]
  double opening = 0;         ///< first step of a communication step, as of the last one where it was cut [s]; 0: it is not

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.h, s.trust, s.next_trust, s.share, s.lasting, s.fades, s.constraints, s.doubts, s.rate, s.explicit_until, s.force,
                  s.opening);
  }
};
static_assert(visits_every_field<DampedRecord>);

/// What stepping has learnt and spent.
struct ControllerState {
  MarkedPoints bound_x;                                  ///< configuration that `bound` belongs to
  double bound = -1;                                     ///< bound of omega [rad/s]; negative: none yet
  double damping_bound = -1;                             ///< of the rate of damping there [1/s]; negative: none yet
  std::array<Calibration, method_count> calibrations{};  ///< of the methods of fixed steps
  std::array<double, method_count> controlled{};         ///< steps of the methods with error control [s]; 0: none yet
  ContactSteps contact{};
  DampedRecord damped{};
  Factored factored{};
  Factored in_contact{};              ///< of the implicit steps of a surface or a solid, where the next may begin with it
  Method method = Method::automatic;  ///< that took the last communication step
  Reason reason = Reason::asked;
  TrialRecord trials{};
  double work = 0;   ///< done since the start, in evaluations of the spring forces
  double usual = 0;  ///< length of communication steps of late [s]
  Count rejected = 0;
  Count factors = 0;  ///< matrices factored
  Neighbour neighbour{};

  Calibration& calibration(Method which) { return calibrations[std::size_t(which)]; }
  double& controlled_step(Method which) { return controlled[std::size_t(which)]; }
  /// What was learnt of another material does not hold; what it has cost does.
  void forget_material() {
    bound = damping_bound = -1;
    calibrations = {};
    contact = {};
    damped = {.force = damped.force};
    factored.h = in_contact.h = 0;
    trials.winner = Method::automatic;
  }

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.bound_x, s.bound, s.damping_bound, s.calibrations, s.controlled, s.contact, s.damped, s.factored, s.in_contact,
                  s.method, s.reason, s.trials, s.work, s.usual, s.rejected, s.factors, s.neighbour);
  }
};
static_assert(visits_every_field<ControllerState>);

/// What contact of the surface's samples keeps from step to step, for each stage: rows by number, plane after plane, -1 behind the last;
/// friction on them in parts of its limit. Empty where control points touch.
struct SurfaceRows {
  std::vector<Count> drift, close;
  Points drift_friction, close_friction;
  double missed = 0;  ///< share of the largest force, or of the slip, by which friction has missed Coulomb's law at most

  void forget() {
    for (auto* rows : {&drift, &close}) std::fill(rows->begin(), rows->end(), -1);
    for (auto* friction : {&drift_friction, &close_friction}) friction->setZero();
  }

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.drift, s.close, s.drift_friction, s.close_friction, s.missed);
  }
};
static_assert(visits_every_field<SurfaceRows>);

/// Where the body is, and what it gave back in this communication step.
struct PhysicalState {
  State motion;
  Clock clock;
  Exchange exchange;  ///< of the last communication step
  Count steps = 0;    ///< internal steps since the start
  StiffContact stiff{};
  SurfaceRows surface{};
  FinalError error{};        ///< of steps beside obstacles
  double damped_error = 0;   ///< of those of damped bodies that are implicit, what lasts to the end of the run [m]
  double damped_fading = 0;  ///< and what is forgotten again [m]

  /// What steps of stiff bodies go by.
  double total_error() const { return error.largest() + stiff.unknown; }

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.motion, s.clock, s.exchange, s.steps, s.stiff, s.surface, s.error, s.damped_error, s.damped_fading);
  }
};
static_assert(visits_every_field<PhysicalState>);

/// Energy that came out of nothing, as watch/energy_watch.hpp counts it.
struct EnergyAccount {
  double kinetic_elastic = -1;     ///< when last looked at [J]; negative: not yet
  double forces = 0;               ///< sum of F^2/m over the free points then [N^2/kg]
  double received = 0;             ///< work of the outside since then, less what friction and impacts took [J]
  double gained = 0;               ///< out of nothing, from the lowest point on [J]
  double balance = 0;              ///< all gains and losses [J]
  double largest = 0;              ///< energy so far [J]
  double recent = 0, earlier = 0;  ///< the same of the last looks, and of as many before them [J]
  Count looks = 0;                 ///< since `recent` began
  double due = 0;                  ///< work at which the next look is due
  double step_factor = 1;          ///< part of the usual internal step that has proved safe
  bool hopeless = false;           ///< smaller steps did not help

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.kinetic_elastic, s.forces, s.received, s.gained, s.balance, s.largest, s.recent, s.earlier, s.looks, s.due,
                  s.step_factor, s.hopeless);
  }
};
static_assert(visits_every_field<EnergyAccount>);

/// What a patch of the surface felt in the last communication step.
struct SensorReading {
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();  ///< on it, torque about its centre [N, N m]
  double area = 0;                                   ///< that touched [m2]
  double pressure = 0, peak = 0;                     ///< mean over that area, and largest [Pa]
  Points taxels;                                     ///< force on each [N]

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.force, s.torque, s.area, s.pressure, s.peak, s.taxels);
  }
};
static_assert(visits_every_field<SensorReading>);

struct Run {
  PhysicalState physical;
  ControllerState control;
  EnergyAccount energy;
  double exchange_time = 1;                        ///< length of the last communication step [s]
  double dissipated = 0, work = 0, potential = 0;  ///< [J]; potential: when last looked at
  double free_energy = 0;                          ///< of free bodies at the start [J]
  MarkedPoints outside;                            ///< outside forces at the end of the last communication step [N]
  Count contacts_resolved = 0;
  std::vector<Count> contacts;  ///< control points, or samples of the surface, on each plane at the communication point
  std::vector<Vec3> centres;    ///< of pressure on each plane in the last communication step, where the plane was at its end [m]
  std::vector<SensorReading> sensors;

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.physical, s.control, s.energy, s.exchange_time, s.dissipated, s.work, s.potential, s.free_energy, s.outside,
                  s.contacts_resolved, s.contacts, s.centres, s.sensors);
  }
};
static_assert(visits_every_field<Run>);

}  // namespace softffd
