#include "stepping/damped_steps.hpp"

#include <algorithm>
#include <cmath>

#include "contact/operations.hpp"
#include "kit/limits.hpp"
#include "kit/outlook.hpp"
#include "kit/snapshot.hpp"
#include "kit/thresholds.hpp"
#include "model/arithmetic.hpp"
#include "stepping/fixed_steps.hpp"
#include "watch/vibration.hpp"

namespace softffd {

namespace thresholds {

/// Work of an implicit step in matrices, where it is compared with explicit steps in its place [1]: some are run twice, others once.
constexpr double damped_runs = 2;
/// First step, and time of explicit steps before implicit ones are tried again, in the shortest that pay; how often that time may double.
constexpr double first_damped = 2, damped_turn = 2;
constexpr Count most_damped_doubts = 6;
/// The errors of all steps may take damped_sum of the tolerance [1]. One step may take damped_fraction of what is left of that, or
/// damped_rate of the tolerance times the ratio of its length to the time that errors are remembered for, whichever is more; damped_most of
/// it at most.
constexpr double damped_sum = 0.5, damped_fraction = 0.2, damped_rate = 1, damped_most = 0.3;
/// Allowed error of a communication step's mean force, relative to the largest force or to what moves a point by the tolerance [1].
constexpr double force_fraction = 0.008, moving_force = 0.01;
/// Error where a constraint changes, relative to the difference of the forces of two runs [1]: both runs step over the same moment and may
/// err alike. Measured on a pad with prescribed motion to and fro: mean forces off by 1.6 % of the largest with 1, by 0.3 % with 3, in as
/// many steps.
constexpr double force_at_events = 3;
/// Longest step, in radians of a vibration, that still differs visibly from two steps of half its length [rad].
constexpr double passed_over = 10;
/// Growth of the first step in a communication step after the one before, whose first step was cut [1].
constexpr double opening_growth = 2;
/// Ratio of a step's error to the bend of its velocities [1]: its least value, its growth since the last step that was run twice up to
/// which the next steps are run once, and a factor for safety. Largest number of steps that are run once.
constexpr double least_fraction = 0.02, ratios_alike = 2, ratio_safety = 1.5;
constexpr Count longest_damped_trust = 32;
/// A step whose error is at most this fraction of the allowed error does not lower that ratio: error and bend are what solutions leave [1].
constexpr double slight_error = 0.01;
/// Contacts that stop, turn round or begin to slide in a step count if their way is above this fraction of the allowed error [1].
constexpr double slight_slip = 0.01;
/// Fraction of what drives a body along an obstacle that friction lets go while vibrations shake the body loose [1].
constexpr double shaken_loose = 0.1;
/// Fraction of the tolerance by which a solution of the equations of a stage may be off [1].
constexpr double solved = 1e-4;
/// Explicit steps are given up at this multiple of their forecast work, contact included [1]: where contacts open and close from step to
/// step, no step is short enough for them.
constexpr double lost_explicit = 100;
/// Operations of the two stages of contact relative to the cube of the number of contact constraints [1]: Coulomb's law at each constraint
/// moves all others in all directions.
constexpr double free_row_work = 20;
/// Shortest step relative to the largest explicit one, if there are no explicit steps to take over [1].
constexpr double shortest_damped = 0.05;

}  // namespace thresholds

namespace {

namespace use = thresholds;

/// A difference of velocities lasts without obstacles, and along an obstacle on which friction does not hold the body.
Outlook ahead(const StepContext& context) {
  const double left = left_of_run(context);
  if (context.drive.planes.empty()) return {Vec3::UnitZ(), left, left, left, 0};
  Outlook ahead = outlook_of_stiff(context, context.run.physical.motion);
  if (ahead.slides_on()) ahead.along_plane = left;
  return ahead;
}

/// Work of the two stages of contact with free obstacles in an explicit step, by the number of contact constraints in the last step of
/// either kind, or by what touched the obstacles when the communication step began.
double work_of_free_rows(const StepContext& context) {
  if (std::ranges::all_of(context.drive.free, &FreeMotion::part)) return 0;
  const auto number = [](const std::vector<Count>& of) { return double(std::ranges::count_if(of, [](Count row) { return row >= 0; })); };
  double rows = std::max(number(context.run.physical.motion.held_rows.rows), number(context.run.physical.surface.drift)), touch = 0;
  for (const FreeMotion& each : context.drive.free)
    if (!each.part()) touch += double(context.run.contacts[each.body().plane]);
  rows = std::max(rows, touch);
  return use::free_row_work * rows * rows * rows / Operations::in_evaluation(context.model.body.points());
}

/// True if explicit steps have taken over until a later time.
bool explicit_turn(const DampedRecord& record, double time) { return record.doubts > 0 && time < record.explicit_until; }

}  // namespace

struct DampedSteps::Call {
  Integrators& integrators;
  const StepContext& context;
  double begin, end;  ///< of the communication step [s]
  double limit;       ///< largest stable explicit step [s]
  double memory;      ///< time until a present error is forgotten [s]
  const ExplicitSteps& others;

  double worth() const { return DampedSteps::worth(integrators, context, others); }
  double tolerance() const { return context.request.tolerance * power(context.request.step_factor, 2); }
  double allowed(double h) const {
    const double spent = (context.run.physical.damped_error + context.run.physical.damped_fading) / context.request.tolerance;
    const double of_rest = use::damped_fraction * std::max(0.0, use::damped_sum - spent);
    return std::max(position_rounding(context), std::min(use::damped_most, std::max(of_rest, use::damped_rate * h / memory)) * tolerance());
  }
};

double DampedSteps::ExplicitSteps::times() const { return free ? 1 : use::doubled_work; }

StepStatus DampedSteps::ExplicitSteps::run(Integrators& integrators, const StepContext& context, double until, double most) const {
  if (free) return run_fitted(integrators, *free, context, Method::leapfrog, until, infinity);
  return contact->run(integrators, context, until, most);
}

double DampedSteps::worth(Integrators& integrators, const StepContext& context, const ExplicitSteps& others) {
  const double limit = step_limit(context, Method::leapfrog, false), known = context.run.control.damped.rate;
  const double forecast = others.times() * step_work(context.model.body, context.drive, context.run, Method::leapfrog, limit) / limit;
  const double free = others.times() * work_of_free_rows(context) / limit;
  return use::damped_runs * integrators.implicit_work().in_contact() / ((known > 0 ? known : forecast) + free);
}

StepStatus DampedSteps::run(Integrators& integrators, const StepContext& context, double end, const ExplicitSteps& others) {
  ControllerState& control = context.run.control;
  DampedRecord& record = control.damped;
  const State& motion = context.run.physical.motion;
  const double begin = motion.time, longest = (end - begin) * context.request.step_factor;  // of the whole: what is left shrinks
  const Count rejected = control.rejected;
  bool opens = false;  // the first step was cut to that of the communication step before
  while (motion.time < end) {
    const Call call{integrators, context, begin, end, step_limit(context, Method::leapfrog, false), memory(context), others};
    control.method = Method::sdirk2;
    const double left = end - motion.time;
    if (integrators.budget().spent()) return StepStatus::too_much_work;
    if (!(record.h > 0)) record.h = std::min(use::first_damped * call.worth(), left);
    if (others.any() && (explicit_turn(record, motion.time) || record.h < call.worth())) {
      if (const StepStatus status = take_explicit(call); status != StepStatus::ok) return status;
      continue;
    }
    const bool first = motion.time == begin;
    if (first && control.rejected == rejected && record.opening > 0 && record.opening < std::min(record.h, left)) {
      opens = true;
      record.h = record.opening;
      record.trust = 0;
    }
    const Count parts = divisions(left, std::min(record.h * context.request.step_factor, longest));
    const double until = parts == 1 ? end : motion.time + left / double(parts);
    const Count constraints = record.constraints;
    if (const StepStatus status = step(call, until); status != StepStatus::ok) return status;
    if (others.contact && motion.time == until) {
      const Span span{start_.motion.time, 0, until - start_.motion.time, 1, infinity, infinity, use::solved * call.tolerance()};
      others.contact->landings().follow(integrators, context, start_.motion, Method::sdirk2, span, record.constraints > constraints);
    }
    if (!first || motion.time == begin) continue;
    const double h = motion.time - begin;
    record.opening = control.rejected > rejected ? h : opens ? std::min(record.h, use::opening_growth * h) : 0;
  }
  return StepStatus::ok;
}

/// Time until a present error is forgotten [s]: pins take a body back to where its slowest vibration dies away.
double DampedSteps::memory(const StepContext& context) {
  const double longest = std::min(context.request.horizon, context.model.longest_memory);
  return !context.drive.held() ? longest : slowest_.memory(context.model.body, longest);
}

/// Books the error of a step of length h, beside what is left of earlier errors after h.
void DampedSteps::book(const Call& call, double h, double error, double lasting) {
  PhysicalState& physical = call.context.run.physical;
  const bool held = call.context.drive.held();
  const double fades = held ? call.memory : call.context.run.control.damped.fades;
  if (held) lasting = 0;
  physical.damped_error += lasting;
  physical.damped_fading = physical.damped_fading * (fades > 0 ? std::max(0.0, 1 - h / fades) : 1) + (error - lasting);
}

/// again: the step before was as long.
DampedSteps::Step DampedSteps::take(const Call& call, double until, bool again) {
  const StepContext& context = call.context;
  PhysicalState& physical = context.run.physical;
  const double h = until - physical.motion.time;
  physical.clock = {physical.motion.time, h, 0};
  const double most = std::max(call.integrators.patience(), use::doubled_work * h / call.limit);
  context.run.energy.kinetic_elastic = -1;  // implicit steps have a guard of their own
  const Outcome outcome = call.integrators.take(context, Method::sdirk2,
                                                {physical.motion.time, 0, h, 1, most, infinity, use::solved * call.tolerance(), again});
  context.run.control.work += outcome.work;
  physical.motion.time = until;
  ++physical.steps;
  const Slip& slip = outcome.slip;
  const bool turned = slip.load > 0 && (slip.stopped + slip.loosened) / slip.load * h > use::slight_slip * call.allowed(h);
  return {outcome.status, outcome.constraints, turned, outcome.bend, outcome.lost, 0.5 * h * slip.rigid};
}

/// Final error by the energy that steps of h have taken from vibrations [m]: that energy cannot lift a body that is pressed on with a force
/// F further than energy / F. While vibrations last, they may shake loose what friction holds with little to spare, so that the body creeps
/// (a box of 0.5 kg on 93 % of the slope that it slides on: by 30 mm in 0.4 s). Zero if internal damping takes the energy within a step, or
/// if the step follows all vibrations.
double DampedSteps::passed_over(const Call& call, double h, double lost) const {
  const StepContext& context = call.context;
  const Body& body = context.model.body;
  const double energy = lost - context.model.noise, time = body.shortest_time();
  if (!(energy > 0) || h < std::max(call.limit, 0.5 * use::passed_over * time)) return 0;
  if (context.drive.held() || context.drive.planes.empty()) return amplitude(context.model, energy, h);
  const double pressing = pressed_since(context, start_.exchange.planes) / h, speed = std::sqrt(2 * energy / body.mass.sum());
  const Outlook out = ahead(context);
  const double lifts = pressing > 0 ? std::min(out.along_normal * speed, energy / pressing) : out.along_normal * speed;
  const double spare = out.grip - out.drive;
  if (!(out.drive > 0 && spare > 0 && speed / h > spare)) return lifts;
  const double lasts = time > 0 ? std::min(out.left, 2 * h * h / time) : out.left;
  return std::max(lifts, use::shaken_loose * 0.5 * out.drive * lasts * lasts);
}

/// Compares the impulses of the two runs on obstacles and pins. Returns their largest difference relative to the allowed one [1], and the
/// largest force so far [N].
DampedSteps::Forces DampedSteps::compare_forces(const Call& call) const {
  const Exchange &begin = start_.exchange, &one = coarse_.exchange, &other = call.context.run.physical.exchange;
  const double h = call.context.run.physical.motion.time - start_.motion.time;
  double largest = call.context.run.control.damped.force, difference = 0;
  const auto compare = [&](const std::vector<Impulse>& from, const std::vector<Impulse>& a, const std::vector<Impulse>& b) {
    for (std::size_t q = 0; q < a.size(); ++q) {
      largest = std::max(largest, (b[q].force - from[q].force).norm() / h);
      difference = std::max(difference, (a[q].force - b[q].force).norm());
    }
  };
  compare(begin.planes, one.planes, other.planes);
  compare(begin.pins, one.pins, other.pins);
  const double of_tolerance =
      power(bound(call.context), 2) * call.context.model.body.mass.minCoeff() * use::moving_force * call.tolerance();
  return {difference / ((call.end - call.begin) * std::max(use::force_fraction * largest, of_tolerance)), largest};
}

/// Takes a step to `until`. The step is run once if its error is small enough, by the bend of its velocities and the last step that was run
/// twice; otherwise it is run with two steps of half the length as well.
StepStatus DampedSteps::step(const Call& call, double until) {
  Run& run = call.context.run;
  DampedRecord& record = run.control.damped;
  const double h = until - run.physical.motion.time, whole = h / call.context.request.step_factor, allowed = call.allowed(h);
  Snapshot snapshot(run.physical, start_);
  const Step coarse = take(call, until);
  if (record.trust > 0) {
    const double bent = record.error_per_bend * coarse.bend, beside = passed_over(call, h, coarse.lost) + coarse.rigid,
                 error = bent + beside;
    if (coarse.status == StepStatus::ok && !coarse.turned && error <= allowed) {
      --record.trust;
      book(call, h, error, record.lasting * bent + beside);
      if (error > 0)
        record.h = std::max(whole * std::clamp(use::window_safety * std::sqrt(allowed / error), use::next_shrink, use::rest_growth),
                            until == call.end ? record.h : whole * use::next_shrink);
      snapshot.commit();
      return StepStatus::ok;
    }
    ++run.control.rejected;
    record.trust = 0;
    record.next_trust = 1;
  }
  Judged judged{.error = infinity, .ratio = infinity};
  if (coarse.status == StepStatus::ok) {
    std::swap(coarse_, run.physical);
    snapshot.rollback();
    judged = run_halves(call, until, allowed, coarse);
  }
  const bool last = h <= use::least_doubled * call.limit || (!call.others.any() && h <= use::shortest_damped * call.limit);
  if (last && !(judged.error < infinity)) return call.integrators.budget().spent() ? StepStatus::too_much_work : StepStatus::not_finite;
  if (judged.ratio <= 1 || last) {
    accept(call, h, allowed, coarse.bend, judged);
    snapshot.commit();
    return StepStatus::ok;
  }
  run.control.rejected += 3;
  record.trust = 0;
  record.next_trust = 1;
  record.h = whole * std::clamp(std::isfinite(judged.ratio) ? judged.growth() : 0, use::window_shrink, use::loss_shrink * 2);
  return StepStatus::ok;
}

/// Runs the two steps of half the length, beside the whole step in coarse_.
DampedSteps::Judged DampedSteps::run_halves(const Call& call, double until, double allowed, const Step& coarse) {
  const StepContext& context = call.context;
  PhysicalState& physical = context.run.physical;
  const double begin = physical.motion.time, h = until - begin;
  const Step first = take(call, begin + 0.5 * h);
  if (first.status != StepStatus::ok) return {.error = infinity, .ratio = infinity};
  const Step second = take(call, until, true);
  if (second.status != StepStatus::ok) return {.error = infinity, .ratio = infinity};
  const Count before = context.run.control.damped.constraints;
  Judged judged{.constraints = second.constraints};
  judged.steady = !coarse.turned && !first.turned && !second.turned && (before == 0 || before == first.constraints) &&
                  first.constraints == second.constraints && second.constraints == coarse.constraints;
  const double order = judged.steady ? 1.0 / 3 : 1;
  const Forces forces = compare_forces(call);
  judged.force = forces.largest;
  const Outlook out = ahead(context);
  const double size = std::max(0.0, final_error(context, coarse_.motion, physical.motion, out).size - rounding_by_end(context));
  judged.error = order * size + first.rigid + second.rigid;
  judged.fades = out.along_normal < out.left ? out.along_normal : 0;
  if (!context.drive.held()) judged.lasting = order * lasting_part(context, coarse_.motion, physical.motion, out, size);
  judged.lasting += first.rigid + second.rigid;
  judged.ratio = std::max(judged.error / allowed, (judged.steady ? order : use::force_at_events) * forces.difference);
  judged.over = passed_over(call, h, first.lost + second.lost);
  judged.steady = judged.steady && judged.over <= judged.ratio * allowed;
  judged.error += judged.over;
  judged.lasting += judged.over;
  judged.ratio = std::max(judged.ratio, judged.error / allowed);
  return judged;
}

/// Factor by which the next step may be longer [1].
double DampedSteps::Judged::growth() const {
  return ratio > 0 ? use::window_safety * (steady ? std::sqrt(1 / ratio) : 1 / ratio) : use::rest_growth;
}

/// Accepts the two half steps. bend: of the whole step.
void DampedSteps::accept(const Call& call, double h, double allowed, double bend, const Judged& judged) {
  Run& run = call.context.run;
  DampedRecord& record = run.control.damped;
  book(call, h, judged.error, judged.lasting);
  record.constraints = judged.constraints;
  record.doubts = 0;
  record.force = judged.force;
  const double of_coarse = (judged.steady ? 4 : 2) * std::max(0.0, judged.ratio * allowed - judged.over), least = use::least_fraction;
  const double per_bend = bend > 0 && bend < infinity ? std::max(of_coarse / bend, least) : least;
  const bool slight = judged.steady && judged.ratio <= use::slight_error && record.error_per_bend > 0;
  const bool known = bend < infinity && (slight || per_bend <= use::ratios_alike * record.error_per_bend);
  if (!slight || per_bend > record.error_per_bend) record.error_per_bend = use::ratio_safety * per_bend;
  record.lasting = judged.error > 0 ? judged.lasting / judged.error : 1;
  record.fades = judged.fades;
  record.trust = known ? record.next_trust : 0;
  record.next_trust = known ? std::min(2 * record.next_trust, use::longest_damped_trust) : 1;
  const double growth = judged.growth(),
               longer = h / call.context.request.step_factor * std::clamp(growth, use::next_shrink, use::rest_growth);
  record.h = growth < 1 ? longer : std::max(record.h, longer);
}

/// Takes explicit steps for a while, which is longer each time that implicit steps do not pay again.
StepStatus DampedSteps::take_explicit(const Call& call) {
  const StepContext& context = call.context;
  DampedRecord& record = context.run.control.damped;
  const double begin = context.run.physical.motion.time;
  if (!explicit_turn(record, begin)) {
    record.explicit_until = begin + double(Count{1} << record.doubts) * use::damped_turn * call.worth();
    record.doubts = std::min(record.doubts + 1, use::most_damped_doubts);
  }
  const double until = std::min(record.explicit_until, call.end);
  context.run.control.method = Method::leapfrog;
  const double before = context.run.control.work, left = call.integrators.budget().left();
  const double forecast = call.others.times() * step_work(context.model.body, context.drive, context.run, Method::leapfrog, call.limit) *
                          (until - begin) / call.limit;
  const double most = std::max(use::lost_explicit * forecast, call.integrators.implicit_work().in_contact());
  const StepStatus status = call.others.run(call.integrators, context, until, most);
  const double now = context.run.physical.motion.time;
  record.rate = (context.run.control.work - before) / (until - begin);
  if (now < until) {  // implicit steps go on
    record.rate = (left - call.integrators.budget().left()) / (now - begin);
    record.explicit_until = now;
  }
  record.h = use::first_damped * call.worth();
  record.constraints = 0;
  return status;
}

}  // namespace softffd
