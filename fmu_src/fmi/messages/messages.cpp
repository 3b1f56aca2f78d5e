#include "messages/messages.hpp"

#include <algorithm>

#include "messages/trouble.hpp"

namespace softffd::fmi {

namespace {

/// Fraction of the stability bound up to which neither friction nor resonance has been observed to excite vibrations of an undamped body.
constexpr double quiet_fraction = 0.3;
/// Error, in units of the tolerance, above which a warning is given, and factor of growth above which the warning is repeated. The stated
/// error is more often than not an upper estimate, but in random scenes it has been a quarter of the true error, for which ten tolerances
/// are promised.
constexpr double doubtful = 2.5, more_doubtful = 2;
/// Error by the error estimate, in units of the tolerance, above which a warning is given. Ten tolerances are promised.
constexpr double broken = 10;
/// Rotation angle per implicit contact step above which a warning of the damped rotation is given [rad].
constexpr double damped_turn = 0.05;
/// Excess of friction over Coulomb's cone, as a fraction of the largest force, above which a warning is given.
constexpr double beside_the_cone = 1e-3;
/// Jump of a pose, as a fraction of the largest side of the box, above which a warning is given [1].
constexpr double noticed_jump = 1e-6;

std::string method_name(Method method, Reason reason) {
  if (reason == Reason::ringing_flight) return "modal superposition in a floating frame";
  switch (method) {
    case Method::automatic: return "auto";
    case Method::central_difference: return "central_difference";
    case Method::leapfrog: return "leapfrog";
    case Method::bm4: return "bm4";
    case Method::rkn12: return "rkn12";
    case Method::dop853: return "dop853";
    case Method::ros34pw2: return "ros34pw2";
    case Method::backward_euler: return "backward Euler with contact";
    case Method::sdirk2: return "sdirk2";
    case Method::floating_frame: return "ros34pw2 in a floating frame";
  }
  return "unknown";
}

std::string reason_text(Reason reason) {
  switch (reason) {
    case Reason::asked: return "as set";
    case Reason::contact: return "an obstacle is near";
    case Reason::damping: return "the method that was set does not handle this damping";
    case Reason::given_step: return "auto with solver.step set";
    case Reason::stability: return "auto: the largest stable step is accurate enough, and no explicit method costs less";
    case Reason::least_work: return "auto: least work for the tolerance";
    case Reason::quiet_stiffness: return "auto: the body is stiff and its fast vibrations are small: implicit steps damp them";
    case Reason::stiff_contact: return "a stiff body rests or slides on an obstacle: implicit steps damp its vibrations";
    case Reason::damped_contact: return "auto: an obstacle is near a body with internal damping";
    case Reason::free_flight: return "auto: a stiff body is in free flight and its fast vibrations are small: implicit steps damp them";
    case Reason::impact: return "a stiff body hits an obstacle, or vibrates on one";
    case Reason::ringing_flight: return "a stiff body is in free flight near an obstacle; its modes describe its vibrations";
    case Reason::damped_motion: return "auto: a pinned body has internal damping: implicit steps where they cost less than explicit ones";
  }
  return "unknown";
}

/// True if a plane, or the frame of a pin, is given no motion beside its pose.
template <class Motion>
bool rests(const Motion& given) {
  return given.velocity.isZero(0) && given.angular_velocity.isZero(0) && given.acceleration.isZero(0) &&
         given.angular_acceleration.isZero(0);
}
bool still(const PlaneMotion& given) { return rests(given) && given.normal_rate.isZero(0) && given.rotation_rate.isZero(0); }
bool still(const PinMotion& given) {
  return rests(given) && std::ranges::none_of(given.orientation_rate, [](double rate) { return rate != 0; });
}

std::string at_time(double time) { return "at time " + number(time) + " s: "; }

std::string rubbing_warning(SoftBody& body) {
  const Readings now = body.readings();
  if (!now.rubs_undamped()) return {};
  return "an undamped body slides on an obstacle with solver.step = " + number(body.settings.step) +
         " s: friction can excite its vibrations; set solver.step below " + within(quiet_fraction * now.stable_step()) +
         " s or to 0, or add damping";
}

/// Automatic steps are made smaller instead, as long as this helps. The warning is given only if it does not, or for given steps.
std::string gain_warning(SoftBody& body, double time) {
  const Readings now = body.readings();
  const double given = body.settings.step;
  if (!now.gains_energy() || (given == 0 && !now.beyond_help())) return {};
  std::string text = "up to time " + number(time) + " s the body has gained " + estimate(now.gained_energy()) +
                     " J by numerical error, where its largest energy is " + estimate(now.largest_energy()) + " J: ";
  if (given > 0)
    text += "solver.step = " + number(given) + " s excites its vibrations; set solver.step below " +
            within(std::min(0.5 * given, quiet_fraction * now.stable_step())) + " s or to 0, or add damping";
  else
    text += "smaller internal steps did not help; add damping, or set a smaller tolerance";
  return text;
}

std::string division_warning(const SoftBody& body, double time) {
  const Readings now = body.readings();
  if (body.divided() == 1) return {};
  return "the communication step to time " + number(time) + " s has no finite result with internal steps of " +
         number(now.internal_step() * body.divided()) + " s; it was repeated with steps of " + number(now.internal_step()) + " s";
}

std::string turning_warning(const SoftBody& body, double time) {
  const Readings now = body.readings();
  const double spin = now.damped_spin(), h = now.internal_step();
  if (!(spin * h > damped_turn)) return {};
  return "at time " + number(time) + " s the stiff body in contact rotates at omega = " + estimate(spin) +
         " rad/s in implicit steps of h = " + estimate(h) +
         " s, which damp the rotation by the fraction omega h / 2 = " + estimate(0.5 * spin * h) +
         " per radian; use communication steps below " + within(damped_turn / spin) +
         " s, or solver.method = leapfrog, which resolves the rotation";
}

/// Warns of friction beyond Coulomb's cone, which occurs on flat faces wedged between planes of different directions.
std::string friction_warning(const SoftBody& body, double time) {
  const double missed = body.run().physical.surface.missed;
  if (!(missed > beside_the_cone)) return {};
  return "up to time " + number(time) +
         " s the friction between the surface and planes with different normals exceeded Coulomb's limit by up to " +
         estimate(100 * missed) +
         " % of the largest force: nothing penetrates and momentum balances, but the amount of sliding is approximate; use fewer vertices "
         "on flat faces, or friction 0 on one of the planes";
}

std::string jump_warning(const std::string& name, double jump, double time) {
  return at_time(time) + "the pose of " + name + " jumped without a velocity, and displaced control points by up to " + estimate(jump) +
         " m; a motion given by poses alone causes an impact at every communication point, and the result depends on the communication "
         "step: set " +
         name + ".velocity too (or .angular_velocity; the scene's `inputs` name them) for a smooth motion between communication points";
}

/// Returns a warning of the first pose that is an input and jumps although its velocity is not set.
std::string jump_warning(const SoftBody& body, const SceneFile& scene, double time) {
  const Readings now = body.readings();
  if (!now.moved) return {};
  const Settings& given = body.settings;
  const double least = noticed_jump * body.lattice().largest_side();
  for (std::size_t a = 0; a < scene.pins.size(); ++a)
    if (scene.pins[a].moved_by_input && still(given.pins[a]) && now.pin_jump(int(a)) > least)
      return jump_warning("pin." + scene.pins[a].name, now.pin_jump(int(a)), time);
  if (given.method == Method::central_difference) return {};  // as published: points get behind planes even without a jump
  for (std::size_t q = 0; q < scene.planes.size(); ++q)
    if (scene.planes[q].moved_by_input && still(given.planes[q]) && now.plane_jump(int(q)) > least)
      return jump_warning(scene.planes[q].path(), now.plane_jump(int(q)), time);
  return {};
}

/// Inverted cells are a valid state of the model, but seldom a wanted one.
std::string folding_warning(const SoftBody& body, const Definition& of, double time) {
  const int folded = body.readings().folded_cells();
  if (folded == 0) return {};
  std::string text = "at time " + number(time) + " s " + std::to_string(folded) + " of the lattice's cells " +
                     (folded == 1 ? "is" : "are") + " inverted (solver.folded_cells); ";
  if (of.solid())
    text += "a solid comes back from it where pins and obstacles leave it room";
  else if (of.volume_stiffness > 0)
    text +=
        "[material] volume_stiffness = " + number(of.volume_stiffness) + " Pa in the scene restores them, and a larger value resists more";
  else
    text +=
        "springs alone may not restore them; [material] volume_stiffness in the scene prevents inversion; a first value is 3 times the "
        "stiffness of a spring divided by the edge of a cell";
  return text;
}

}  // namespace

void Messages::not_set_up() {
  once(set_up, [] {
    return std::string("fmi2SetupExperiment was not called: the run starts at time 0 s, has no stop time and keeps solver.tolerance");
  });
}

void Messages::two_tolerances(double set, double asked, bool asked_wins) {
  logger_.log(fmi2Warning, log_warning,
              "solver.tolerance was set to " + number(set) + ", and the host gave the run the tolerance " + number(asked) +
                  (asked_wins ? "" : ", that of DefaultExperiment") + ": " + number(asked_wins ? asked : set) + " is used");
}

void Messages::begun(const SoftBody& body, double time) {
  report_threads();
  warn_of_folding(body, time);
  for (const std::string& strained : strained_by_pins(scene_, body)) logger_.log(fmi2Warning, log_warning, at_time(time) + strained);
  if (body.readings().undecided())  // comes here only with a given step; otherwise the start fails
    logger_.log(fmi2Warning, log_warning, at_time(time) + without_direction(scene_, body));
  else if (const std::string behind = behind_planes(scene_, body); !behind.empty())
    logger_.log(fmi2Warning, log_warning, at_time(time) + behind + "; " + clear_of_planes);
}

void Messages::stepped(SoftBody& body, double time, double length, double estimated) {
  once(rubbing, [&] { return rubbing_warning(body); });
  report_choice(body);
  warn_of_folding(body, time);
  report_step_factor(body, time);
  once(gain, [&] { return gain_warning(body, time); });
  once(division, [&] { return division_warning(body, time); });
  once(turning, [&] { return turning_warning(body, time); });
  once(friction, [&] { return friction_warning(body, time); });
  if (logger_.on(log_warning)) once(jump, [&] { return jump_warning(body, scene_, time - length); });
  report_error(body, time);
  report_estimate(body, time, estimated);
}

/// Reports the number of threads if the lattice is too small for all threads of the scene.
void Messages::report_threads() {
  const Definition& of = scene_.definition;
  const int members = of.team ? of.team->members() : 1;
  if (scene_.threads == members || !logger_.on(log_solver)) return;
  logger_.log(fmi2OK, log_solver,
              "solver.threads = " + std::to_string(scene_.threads) + ": a lattice of " + std::to_string(of.lattice.points()) +
                  " control points uses " + std::to_string(members) + (members > 1 ? " threads" : " thread"));
}

/// Counting inverted cells costs more than the other checks. It is therefore done only while warnings are logged.
void Messages::warn_of_folding(const SoftBody& body, double time) {
  if (logger_.on(log_warning)) once(folding, [&] { return folding_warning(body, scene_.definition, time); });
}

/// Warns once of a large error, and again if the error has become several times the stated one.
void Messages::report_error(const SoftBody& body, double time) {
  const double lost = body.readings().stated_error(), allowed = body.settings.tolerance * body.lattice().largest_side();
  if (!(lost > std::max(doubtful * allowed, more_doubtful * reported_.error)) || !logger_.on(log_warning)) return;
  reported_.error = lost;
  const bool phases = body.readings().landing_error() > 0.5 * lost, tumbles = body.readings().tumbling_error() > 0.5 * lost;
  logger_.log(
      fmi2Warning, log_warning,
      at_time(time) +
          (tumbles ? "rounding grows while the body tumbles about its middle axis of inertia"
                   : "the tolerance could not be met in contact") +
          ": the result may be wrong by " + estimate(lost) + " m, where the tolerance allows " + estimate(allowed) + " m; " +
          (tumbles ? "only a shorter run is more accurate"
           : phases
               ? "the next impact depends on the phase of the vibration after the last one, which is not accurate enough for this; add "
                 "damping, or try a smaller tolerance"
               : "set a smaller tolerance, or add damping"));
}

/// Warns of an error that the error estimate has found and nothing else has stated. No tolerance applies to given steps.
void Messages::report_estimate(const SoftBody& body, double time, double estimated) {
  const double allowed = body.settings.tolerance * body.lattice().largest_side();
  if (body.settings.step > 0 || !(estimated > std::max(broken * allowed, more_doubtful * reported_.error)) || !logger_.on(log_warning))
    return;
  reported_.error = estimated;
  logger_.log(fmi2Warning, log_warning,
              at_time(time) + "solver.error_estimate = " + estimate(estimated) + " m, where the tolerance allows " + estimate(allowed) +
                  " m at the end of the run; if it does not fall again, set a smaller tolerance");
}

void Messages::report_step_factor(const SoftBody& body, double time) {
  const Readings now = body.readings();
  if (now.step_factor() >= reported_.step_factor) return;
  reported_.step_factor = now.step_factor();
  logger_.log(fmi2OK, log_solver,
              at_time(time) + "the body gained energy with its usual internal steps; from now on they are multiplied by " +
                  number(reported_.step_factor));
}

/// Reports the method of a step and its reason if either has changed, or if a given step has to be divided much further than before.
void Messages::report_choice(SoftBody& body) {
  const Readings now = body.readings();
  const double h = now.internal_step(), asked = body.settings.step;
  const bool divided = asked > h * (1 + 1e-9) && asked > now.stable_step();
  if (now.method() == reported_.method && now.reason() == reported_.reason && !(divided && h < 0.5 * reported_.step)) return;
  reported_.method = now.method();
  reported_.reason = now.reason();
  reported_.step = h;
  const char* category = divided ? log_warning : log_solver;
  if (!logger_.on(category)) return;
  std::string text = method_name(now.method(), now.reason()) + ": " + reason_text(now.reason());
  if (divided)
    text += "; internal step " + number(h) + " s, a fraction of solver.step = " + number(asked) +
            " s, which is above the stability bound " + within(now.stable_step()) + " s";
  else
    text += "; internal step of this communication step " + number(h) + " s";
  logger_.log(divided ? fmi2Warning : fmi2OK, category, text);
}

}  // namespace softffd::fmi
