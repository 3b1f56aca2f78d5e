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

/// Reason for the method of a communication step.
enum class Reason {
  asked,            ///< it was asked for
  contact,          ///< an obstacle is within reach
  damping,          ///< the method asked for cannot follow the damping
  given_step,       ///< automatic choice, with a given internal step
  stability,        ///< the largest stable step is accurate enough: no explicit method costs less
  least_work,       ///< least work for the tolerance among the candidates
  quiet_stiffness,  ///< stiff, and the fast modes are quiet: implicit steps do not resolve them
  stiff_contact,    ///< an obstacle is within reach of a stiff body
  damped_contact,   ///< an obstacle is within reach of a body with internal damping
  free_flight,      ///< stiff and free, and the fast modes are quiet: rigid motion, and implicit steps for the deformation
  impact,           ///< a stiff body strikes an obstacle, or rings on one
  ringing_flight,   ///< a stiff body flies beside an obstacle: its modes carry the vibrations
  damped_motion     ///< a pinned body with internal damping away from obstacles: implicit steps where they pay, else explicit ones
};
constexpr Reason last(Reason) { return Reason::damped_motion; }

/// Step of a fixed-step method, found by trial: runs with h and h / 2 over a short sub-interval are compared.
struct Calibration {
  double h = 0;       ///< largest step that keeps the tolerance [s]; 0: not known yet
  double due = 0;     ///< work at which the next calibration is due
  double window = 0;  ///< length of the last trial [s]: a much shorter one teaches little

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.h, s.due, s.window);
  }
};
static_assert(visits_every_field<Calibration>);

/// Difference of two runs of a sub-interval as it will be at the end of the run, or a sum of such differences [m]. Most sub-intervals err
/// now in one direction, now in another: their sizes add like the lengths of vectors at right angles. Errors that repeat in one direction,
/// as in rolling, are recognised by their direction.
struct FinalError {
  double size = 0;
  double lag = 0;                                  ///< sum of sizes if pins hold the body: phases of its vibrations always fall behind
  Vec3 shift = Vec3::Zero(), turn = Vec3::Zero();  ///< without pins: shift of the whole body; way of its outermost point by its turn

  double largest() const { return std::max({size, lag, shift.norm(), turn.norm()}); }
  FinalError times(double factor) const { return {factor * size, factor * lag, factor * shift, factor * turn}; }
  void add(const FinalError& of) { *this = {hypotenuse(size, of.size), lag + of.lag, shift + of.shift, turn + of.turn}; }
  /// Updates the error to that of sub-intervals like the last one: directions that change cancel.
  void learn(const FinalError& last) { *this = {last.size, last.lag, 0.5 * (shift + last.shift), 0.5 * (turn + last.turn)}; }

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.size, s.lag, s.shift, s.turn);
  }
};
static_assert(visits_every_field<FinalError>);

/// A sub-interval that was run twice (step doubling).
struct TriedStretch {
  double h = 0;         ///< step of the coarser run [s]; 0: none
  double error = 0;     ///< forecast of the final error [m]
  bool impact = false;  ///< something came onto an obstacle in the sub-interval

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.h, s.error, s.impact);
  }
};
static_assert(visits_every_field<TriedStretch>);

/// Error that shorter steps do not reduce.
struct ErrorFloor {
  double error = 0;  ///< forecast of the final error [m]
  Count left = 0;    ///< sub-intervals that may have this error before shorter steps are tried again
  Count next = 1;    ///< value of `left` after the next vain attempt with shorter steps

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.error, s.left, s.next);
  }
};
static_assert(visits_every_field<ErrorFloor>);

/// Steps through contact. Each sub-interval is run twice unless experience says that the largest stable step is accurate enough.
struct ContactSteps {
  double h = 0;         ///< step of the coarser of the two runs [s]; 0: none yet
  Count free = 0;       ///< sub-intervals without impact that may be run once, at the largest stable step
  Count free_next = 1;  ///< value of `free` after the next success
  Count impact = 0;     ///< the same for sub-intervals with an impact
  Count impact_next = 1;
  bool touches = false;                  ///< in the last sub-interval something touched that had not come onto an obstacle in it
  Count seen = 0;                        ///< steps since a whole sub-interval was completed
  double largest = 0, largest_seen = 0;  ///< error / step^2 [m/s2]: since then, and in the whole sub-interval before
  FinalError final_error{};              ///< of one sub-interval with the step of the coarser run
  TriedStretch tried{};                  ///< last sub-interval whose error shorter steps are to reduce
  ErrorFloor floor{};

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.h, s.free, s.free_next, s.impact, s.impact_next, s.touches, s.seen, s.largest, s.largest_seen, s.final_error, s.tried,
                  s.floor);
  }
};
static_assert(visits_every_field<ContactSteps>);

/// Possible error of positions, as a function of time.
struct Drift {
  double place = 0, speed = 0;  ///< error of positions, and its rate, at `time` [m, m/s]
  double time = 0;              ///< [s]

  /// Returns the error of positions at a time [m]. lasting: how long a velocity lasts at most [s].
  double at(double now, double lasting) const { return place + speed * std::clamp(now - time, 0.0, lasting); }

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.place, s.speed, s.time);
  }
};
static_assert(visits_every_field<Drift>);

/// A second motion of the body. It begins a landing as far from the run as the run may be in error; the difference between the two shows
/// what landings make of errors (kit/landings.hpp). Empty without obstacles.
struct Neighbour {
  Points x, v;                    ///< while integrated beside the run, its own; else its last difference from the run [m, m/s]
  std::vector<FreeState> free{};  ///< free bodies, likewise
  bool follows = false;           ///< it is integrated beside the run
  bool landed = false;            ///< it has come onto an obstacle since it last began to follow
  double began = 0, impact = 0;   ///< times at which it last began to follow, and of the run's last impact [s]
  Drift off{};                    ///< its distance from the run

  /// Discards the motion and ends the integration beside the run. The last distance `off` stays.
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

/// Phase of a stiff body beside obstacles (impacts/impacts.hpp).
enum class Phase {
  flight,   ///< no obstacle can be touched
  impact,   ///< near an obstacle after a flight: explicit steps that follow the vibrations
  contact,  ///< the same as impact, for some time already
  rest      ///< pressed onto an obstacle, and so quiet that long implicit steps lose nothing that matters
};
constexpr Phase last(Phase) { return Phase::rest; }

struct StiffContact {
  Phase phase = Phase::flight;
  bool settling = false;  ///< the next step at rest is the first one
  Count looks = 0;        ///< looks at the vibrations, since the current measurement of them began
  double impulse = 0;     ///< impulse on the obstacles since then [N s]
  double listened = 0;    ///< length of the measurement [s]
  double loudest = 0;     ///< largest kinetic energy of deformation since then [J]; with pins, largest size of the vibrations [m]
  double pressing = 0;    ///< force on the obstacles, last known value [N]
  double since = 0;       ///< start of the impact [s]
  Count doubts = 0;       ///< how often rest was left too early to pay off
  Count trust = 0;        ///< windows that may be run once
  Count next_trust = 1;   ///< value of `trust` after the next success
  FinalError trusted{};   ///< final error of one such window, as of the last window that was run twice
  Count rest_trust = 0, next_rest_trust = 1;  ///< the same for steps at rest
  double step = 0;                            ///< step size at rest [s]; 0: none yet
  double damped = 0;                          ///< energy that steps at rest have taken and damping would have left [J]
  double unknown = 0;                         ///< error that unknown phases of the vibrations at impacts may have added [m]
  double flown = 0;                           ///< possible error of vibrations in flight [m]; 0: not known

  /// Begins a phase anew. Possible errors stay, and so does the number of doubts unless the phase is a flight.
  void begin(Phase next) {
    *this = {.phase = next, .doubts = next == Phase::flight ? 0 : doubts, .damped = damped, .unknown = unknown, .flown = flown};
  }

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.phase, s.settling, s.looks, s.impulse, s.listened, s.loudest, s.pressing, s.since, s.doubts, s.trust, s.next_trust,
                  s.trusted, s.rest_trust, s.next_rest_trust, s.step, s.damped, s.unknown, s.flown);
  }
};
static_assert(visits_every_field<StiffContact>);

/// Results of the trial runs between methods, and the work at which the next ones are due.
struct TrialRecord {
  Method winner = Method::automatic;  ///< automatic: none yet
  Reason reason = Reason::least_work;
  double due = 0;       ///< work at which the next trial runs are due
  double pause = 1;     ///< work until the next trial runs, in multiples of the trial runs' own work
  double window = 0;    ///< communication step of the last trial runs [s]
  double forecast = 0;  ///< forecast of the winner's work for what is left of the communication step

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.winner, s.reason, s.due, s.pause, s.window, s.forecast);
  }
};
static_assert(visits_every_field<TrialRecord>);

/// Implicit second-order steps of a damped body that is beside obstacles or pinned (stepping/damped_steps.hpp).
struct DampedRecord {
  double h = 0;               ///< next step wanted [s]; 0: none yet
  Count trust = 0;            ///< steps that may be run once
  Count next_trust = 1;       ///< value of `trust` after the next success
  double error_per_bend = 1;  ///< ratio of a step's error to the bend of its velocities, as of the last step that was run twice [1]
  double lasting = 1;         ///< fraction of that error that lasts [1]
  double fades = 0;           ///< time in which the rest fades if no pin holds the body [s]; 0: it does not fade
  Count constraints = 0;      ///< number of contact constraints at the end of the last step
  Count doubts = 0;           ///< how often in succession explicit steps had to take over
  double rate = 0;            ///< work of explicit steps per second of the run, as of the last that took over; 0: not known
  double explicit_until = 0;  ///< time until which explicit steps took over, the last time [s]
  double force = 0;           ///< largest force on an obstacle or a pin so far, as the mean over a step [N]
  double opening = 0;         ///< first step of the next communication step, if that of the last one was cut [s]; 0: it was not

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.h, s.trust, s.next_trust, s.error_per_bend, s.lasting, s.fades, s.constraints, s.doubts, s.rate, s.explicit_until,
                  s.force, s.opening);
  }
};
static_assert(visits_every_field<DampedRecord>);

/// How the turning of a free body multiplies errors until the end of the run (kit/tumbling.hpp).
struct Tumbling {
  double growth = 1;  ///< factor by which an error of the attitude grows, the mean over the rest of the run [1]
  double until = std::numeric_limits<double>::lowest();  ///< time at which the factor is due to be found anew [s]
  double error = 0;                                      ///< final error that rounding may amount to [m]

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.growth, s.until, s.error);
  }
};
static_assert(visits_every_field<Tumbling>);

/// What the steps so far have taught, and the work spent.
struct ControllerState {
  MarkedPoints bound_x;                                  ///< configuration that `bound` belongs to
  double bound = -1;                                     ///< upper bound of omega [rad/s]; negative: none yet
  double damping_bound = -1;                             ///< upper bound of the rate of damping there [1/s]; negative: none yet
  std::array<Calibration, method_count> calibrations{};  ///< of the methods with fixed steps
  std::array<double, method_count> controlled{};         ///< steps of the methods with error control [s]; 0: none yet
  ContactSteps contact{};
  DampedRecord damped{};
  Factored factored{};
  Factored in_contact{};              ///< matrix of the implicit steps of a surface or a solid, with which the next step may begin
  Method method = Method::automatic;  ///< method of the last communication step
  Reason reason = Reason::asked;
  TrialRecord trials{};
  double work = 0;       ///< work since the start, in evaluations of the spring forces
  double usual = 0;      ///< length of recent communication steps [s]
  double vibration = 0;  ///< size of the vibrations that fixed steps and methods were last chosen for [m]
  double stirred = 0;    ///< size of those that may have been set off since [m]
  Count rejected = 0;
  Count factors = 0;  ///< matrices factored
  Neighbour neighbour{};
  Tumbling tumbling{};

  Calibration& calibration(Method which) { return calibrations[std::size_t(which)]; }
  double& controlled_step(Method which) { return controlled[std::size_t(which)]; }
  /// Discards what was learnt about another material and no longer holds. What was spent stays.
  void forget_material() {
    bound = damping_bound = -1;
    calibrations = {};
    contact = {};
    damped = {.force = damped.force};
    factored.h = in_contact.h = 0;
    tumbling.until = Tumbling{}.until;
    trials.winner = Method::automatic;
  }
  /// Makes all trials due at once: vibrations have become larger than those that steps were chosen for.
  void doubt_steps() {
    for (Calibration& each : calibrations) each.due = 0;
    trials.due = 0;
    tumbling.until = Tumbling{}.until;
    contact.free = contact.impact = 0;
    contact.free_next = contact.impact_next = 1;
  }

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.bound_x, s.bound, s.damping_bound, s.calibrations, s.controlled, s.contact, s.damped, s.factored, s.in_contact,
                  s.method, s.reason, s.trials, s.work, s.usual, s.vibration, s.stirred, s.rejected, s.factors, s.neighbour, s.tumbling);
  }
};
static_assert(visits_every_field<ControllerState>);

/// Warm start of the contact of the surface's samples from step to step, for each of the two stages: contact constraints by number, plane
/// after plane, -1 behind the last; friction as a fraction of the Coulomb limit. Empty if control points meet the obstacles.
struct SurfaceRows {
  std::vector<Count> drift, close;
  Points drift_friction, close_friction;
  double missed = 0;  ///< largest error in Coulomb's law so far, as a fraction of the largest force or of the slip

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

/// Motion of the body, and its reactions on the outside in this communication step.
struct PhysicalState {
  State motion;
  Clock clock;
  Exchange exchange;  ///< of the last communication step
  Count steps = 0;    ///< internal steps since the start
  StiffContact stiff{};
  SurfaceRows surface{};
  FinalError error{};        ///< of steps beside obstacles
  double damped_error = 0;   ///< error of implicit steps of damped bodies that lasts to the end of the run [m]
  double damped_fading = 0;  ///< error of these steps that fades again [m]

  /// Returns the error that controls the steps of stiff bodies [m].
  double total_error() const { return error.largest() + stiff.unknown; }

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.motion, s.clock, s.exchange, s.steps, s.stiff, s.surface, s.error, s.damped_error, s.damped_fading);
  }
};
static_assert(visits_every_field<PhysicalState>);

/// Account of energy that came out of nothing (watch/energy_watch.hpp).
struct EnergyAccount {
  double kinetic_elastic = -1;     ///< kinetic + elastic energy at the last look [J]; negative: no look yet
  double forces = 0;               ///< sum of F^2/m over the free points at the last look [N^2/kg]
  double received = 0;             ///< work of the outside since the last look, less what friction and impacts took [J]
  double gained = 0;               ///< energy out of nothing, from the lowest point on [J]
  double balance = 0;              ///< sum of all gains and losses [J]
  double largest = 0;              ///< largest energy so far [J]
  double recent = 0, earlier = 0;  ///< largest energy in the last looks, and in as many looks before them [J]
  Count looks = 0;                 ///< number of looks since `recent` began
  double due = 0;                  ///< work at which the next look is due
  double step_factor = 1;          ///< factor of the usual internal step that has proved safe
  bool hopeless = false;           ///< smaller steps did not help

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.kinetic_elastic, s.forces, s.received, s.gained, s.balance, s.largest, s.recent, s.earlier, s.looks, s.due,
                  s.step_factor, s.hopeless);
  }
};
static_assert(visits_every_field<EnergyAccount>);

/// Reading of a sensor, a patch of the surface, in the last communication step.
struct SensorReading {
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();  ///< on the patch, torque about its centre [N, N m]
  double area = 0;                                   ///< touched area [m2]
  double pressure = 0, peak = 0;                     ///< mean over the touched area, and largest [Pa]
  Points taxels;                                     ///< force on each taxel [N]

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
  double pin_time = 0;                             ///< time of the impulses of pins that wait for their means [s] (watch/means.hpp)
  double hidden = 0;                               ///< momentum that forces gave in steps that wait for their means [N s] (watch/means.hpp)
  double dissipated = 0, work = 0, potential = 0;  ///< [J]; potential: as of the last look
  double free_energy = 0;                          ///< energy of free bodies at the start [J]
  MarkedPoints outside;                            ///< outside forces at the end of the last communication step [N]
  Count contacts_resolved = 0;
  std::vector<Count> contacts;  ///< number of control points, or surface samples, that touch each plane at the communication point
  std::vector<Wrench> plane_reactions, pin_reactions;  ///< means on the obstacles, about their points, and on the pins, about their origins
  std::vector<Vec3> centres;  ///< centre of pressure on each plane in the last communication step, with the plane as at its end [m]
  std::vector<SensorReading> sensors;

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.physical, s.control, s.energy, s.pin_time, s.hidden, s.dissipated, s.work, s.potential, s.free_energy, s.outside,
                  s.contacts_resolved, s.contacts, s.plane_reactions, s.pin_reactions, s.centres, s.sensors);
  }
};
static_assert(visits_every_field<Run>);

}  // namespace softffd
