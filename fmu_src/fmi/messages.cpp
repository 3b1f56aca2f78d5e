/// What an instance says in words: its method and why, warnings, reasons of refusals.
#include <cmath>

#include "instance.hpp"

namespace softffd::fmi {

namespace {

/// Share of the stability bound up to which neither friction nor resonance has been seen to feed an undamped body's vibrations.
constexpr double quiet_share = 0.3;
/// Angle of an implicit contact step from which on what it takes from a rotation is worth a word [rad].
constexpr double damped_turn = 0.05;
/// Depth behind a plane relative to the box that is rounding.
constexpr double slight = 1e-9;

constexpr const char* clear_of_planes = "to start clear of it move the plane or initial.offset, or turn the plane's normal round";

std::string method_name(Method method) {
  switch (method) {
    case Method::automatic: return "auto";
    case Method::central_difference: return "central_difference";
    case Method::leapfrog: return "leapfrog";
    case Method::bm4: return "bm4";
    case Method::rkn12: return "rkn12";
    case Method::dop853: return "dop853";
    case Method::ros34pw2: return "ros34pw2";
    case Method::backward_euler: return "backward Euler with contact";
    case Method::floating_frame: return "rigid motion with ros34pw2 in its frame";
  }
  return "unknown";
}

std::string reason_text(Reason reason) {
  switch (reason) {
    case Reason::asked: return "as asked";
    case Reason::contact: return "an obstacle is within reach";
    case Reason::damping: return "rkn12 was asked for, but the body is damped";
    case Reason::given_step: return "auto with a given solver.step";
    case Reason::stability: return "auto: the largest stable step is accurate enough, and nothing explicit costs less";
    case Reason::least_work: return "auto: least work for the tolerance";
    case Reason::quiet_stiffness: return "auto: stiff, with quiet fast modes, which implicit steps pass over";
    case Reason::stiff_contact:
      return "an obstacle is within reach of a stiff body: implicit steps of first order, which damp vibrations, rebound and spin";
    case Reason::free_flight: return "auto: a stiff body in free flight, with quiet fast modes, which implicit steps pass over";
  }
  return "unknown";
}

}  // namespace

std::string Instance::describe(StepStatus status, double time, double step) const {
  const std::string where = "at time " + number(time) + " s: ";
  switch (status) {
    case StepStatus::ok:
    case StepStatus::contact_ahead: return "done";
    case StepStatus::impossible_planes:
      return where + "the obstacle planes leave a control point no place to go; move or turn the planes so that they do not close on it";
    case StepStatus::pin_behind_plane:
      return where + "a pinned control point is behind an obstacle plane; the pin's and the plane's motions contradict each other";
    case StepStatus::zero_normal: return where + "a plane's normal is the zero vector; wanted any other vector";
    case StepStatus::zero_orientation: return where + "a pin's orientation is the zero quaternion; wanted any other, e.g. (1, 0, 0, 0)";
    case StepStatus::undecided: return where + describe_undecided();
    case StepStatus::too_many_steps:
      return where + "a communication step of " + number(step) + " s needs more than " + std::to_string(Propagator::most_steps) +
             " internal steps; use a shorter communication step, a longer solver.step or less stiffness per mass";
    case StepStatus::not_finite:
      return where + "the result of a communication step of " + number(step) +
             " s is not finite, and not with smaller internal steps either: forces, speeds or stiffness are beyond what they can follow";
  }
  return where + "unknown trouble";
}

std::string Instance::describe_undecided() const {
  const bool drawn_flat = (scene_.definition.stretch.array() == 0).any();
  const std::string behind = drawn_flat ? "" : start_behind_planes();
  const std::string why = behind.empty() ? "control points that they join are at the same place" : behind;
  std::string cure = behind.empty() ? "draw the points apart (no 0 in initial.stretch)" : clear_of_planes;
  if (behind.empty() && !(body_.settings.step > 0)) cure += ", or give a solver.step, to which none applies";
  return "springs have no length, because " + why + ": rounding would decide which way they push, and no tolerance could hold; " + cure;
}

/// Which control points the start has behind obstacle planes, whence they are moved at once; empty where there are none.
std::string Instance::start_behind_planes() const {
  const Definition& d = scene_.definition;
  if (body_.settings.method == Method::central_difference) return {};  // moves none
  std::vector<bool> pinned(d.lattice.points(), false);
  for (const PinDefinition& pin : d.pins)
    for (int p : pin.points) pinned[p] = true;
  const Points start = start_positions(d);
  std::string text;
  for (std::size_t q = 0; q < scene_.planes.size(); ++q) {
    const Settings::PlaneInput& plane = body_.settings.planes[q];
    const Vec3 normal = plane.normal / plane.normal.stableNorm();
    int count = 0;
    double deepest = 0;
    for (int p = 0; p < d.lattice.points(); ++p) {
      const double depth = normal.dot(plane.point - row(start, p));
      if (pinned[p] || !(depth > slight * d.lattice.largest_side())) continue;
      ++count;
      deepest = std::max(deepest, depth);
    }
    if (count > 0)
      text += (text.empty() ? "" : " and ") + std::to_string(count) + " control point" + (count > 1 ? "s start" : " starts") +
              " behind plane " + scene_.planes[q].name + ", by up to " + number(deepest) + " m";
  }
  return text.empty() ? text : text + ", and are moved out at once";
}

void Instance::log_solver_choice() {
  if (!warned_of_rubbing_ && body_.rubs_undamped()) {
    warned_of_rubbing_ = true;
    logger.log(fmi2Warning, log_warning,
               "an undamped body rubs against an obstacle at solver.step = " + number(body_.settings.step) +
                   " s: friction can feed its vibrations; take less than " + number(quiet_share * body_.stable_step()) +
                   " s, leave solver.step at 0, or give the body some damping");
  }
  const Method method = body_.method();
  const double h = body_.internal_step(), asked = body_.settings.step;
  const bool divided = asked > h * (1 + 1e-9) && asked > body_.stable_step();
  if (int(method) == logged_method_ && body_.reason() == logged_reason_ && !(divided && h < 0.5 * logged_step_)) return;
  logged_method_ = int(method);
  logged_reason_ = body_.reason();
  logged_step_ = h;
  const char* category = divided ? log_warning : log_solver;
  if (!logger.on(category)) return;
  std::string text = method_name(method) + ": " + reason_text(body_.reason());
  if (divided)
    text += "; internal step " + number(h) + " s, a part of solver.step = " + number(asked) + " s, which is above the stability bound " +
            number(body_.stable_step()) + " s";
  else
    text += "; internal step of this communication step " + number(h) + " s";
  logger.log(divided ? fmi2Warning : fmi2OK, category, text);
}

/// Once in a run: that cells are turned inside out is a state of the model like any other, but seldom a wanted one.
void Instance::warn_of_folding() {
  if (warned_of_folding_ || !logger.on(log_warning)) return;
  const int folded = body_.folded_cells();
  if (folded == 0) return;
  warned_of_folding_ = true;
  const double given = scene_.definition.volume_stiffness;
  std::string text = "at time " + number(time_) + " s " + std::to_string(folded) + " of the lattice's cells " +
                     (folded == 1 ? "is" : "are") + " turned inside out (solver.folded_cells); ";
  if (given > 0)
    text += "[material] volume_stiffness = " + number(given) + " Pa in the scene pushes them back, a larger one resists more";
  else
    text +=
        "springs alone may leave them so; [material] volume_stiffness in the scene keeps cells from folding, a good first value is "
        "3 times a spring's stiffness by the edge of a cell";
  logger.log(fmi2Warning, log_warning, text);
}

/// Once in a run.
void Instance::warn_of_division() {
  if (warned_of_division_ || body_.divided() == 1) return;
  warned_of_division_ = true;
  logger.log(fmi2Warning, log_warning,
             "up to time " + number(time_) + " s internal steps of " + number(body_.internal_step() * body_.divided()) +
                 " s give a result that is not finite; the communication step was done again with steps of " +
                 number(body_.internal_step()) + " s");
}

/// A start without direction passes with a given step only.
void Instance::warn_of_start() {
  const std::string where = "at time " + number(time_) + " s: ";
  if (body_.undecided())
    logger.log(fmi2Warning, log_warning, where + describe_undecided());
  else if (const std::string behind = start_behind_planes(); !behind.empty())
    logger.log(fmi2Warning, log_warning, where + behind + "; " + clear_of_planes);
}

/// Once in a run.
void Instance::warn_of_turning() {
  if (warned_of_turning_) return;
  const double spin = body_.damped_spin(), h = body_.internal_step();
  if (!(spin * h > damped_turn)) return;
  warned_of_turning_ = true;
  logger.log(fmi2Warning, log_warning,
             "at time " + number(time_) + " s the stiff body in contact turns at omega = " + number(spin) +
                 " rad/s in implicit steps of h = " + number(h) + " s, which take the share omega h / 2 = " + number(0.5 * spin * h) +
                 " a radian from the rotation; take communication steps below " + number(damped_turn / spin) +
                 " s, or solver.method = leapfrog, which resolves it");
}

/// A warning once in a run. Steps of the component's choice are made smaller instead, as long as that helps.
void Instance::warn_of_gain() {
  if (body_.step_share() < logged_share_) {
    logged_share_ = body_.step_share();
    logger.log(fmi2OK, log_solver,
               "at time " + number(time_) + " s: the body gained energy at its usual internal steps; it takes " + number(logged_share_) +
                   " of them from here on");
  }
  const double given = body_.settings.step;
  if (warned_of_gain_ || !body_.gains_energy() || (given == 0 && !body_.beyond_help())) return;
  warned_of_gain_ = true;
  std::string text = "up to time " + number(time_) + " s the body has gained " + number(body_.gained_energy()) +
                     " J that nothing outside gave it, of " + number(body_.largest_energy()) + " J at most: ";
  if (given > 0)
    text += "solver.step = " + number(given) + " s feeds its vibrations; take less than " +
            number(std::min(0.5 * given, quiet_share * body_.stable_step())) + " s, leave solver.step at 0, or give the body more damping";
  else
    text += "smaller internal steps did not help; give the body more damping, or a smaller tolerance";
  logger.log(fmi2Warning, log_warning, text);
}

}  // namespace softffd::fmi
