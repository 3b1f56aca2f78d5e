#include "stepping/plan.hpp"

#include "kit/thresholds.hpp"
#include "methods/traits.hpp"
#include "model/arithmetic.hpp"

namespace softffd {

namespace thresholds {

/// A candidate has to need less work than the last winner by this factor [1]: measured, without it winners changed up to 27 times in a run.
constexpr double challenge = 1.2;
/// H omega / 2 above which implicit steps in the body's frame are worth a trial for a body that turns freely [1]: the frame takes work too.
/// By experience.
constexpr double stiff_turning = 100;
/// Implicit steps must not pass over a vibration above this multiple of the tolerance [1]: the vibration is known by a bound. By
/// experience.
constexpr double loud = 3;
/// Nothing else is tried if leapfrog's work is at most this multiple of the work that stability requires [1]: per evaluation of the forces
/// no method is stable for as long as leapfrog (bm4 has a third of its interval), so that the trials would cost more than they find.
constexpr double enough = 1.7;

}  // namespace thresholds

namespace {

namespace use = thresholds;

/// The method that is asked for, or a substitute. The stages of rkn12 have no velocity, so it has a substitute with any damping. Two
/// methods cannot take the dashpots' coupling of velocities: bm4's coefficients are for kicks that do not depend on velocities, and the
/// central difference is as published.
struct Asked {
  Method method;
  Reason reason;
};

Asked asked(const Facts& facts) {
  if (facts.surface && !meets_surface(facts.asked)) return {Method::leapfrog, Reason::contact};
  if (facts.asked == Method::rkn12 && facts.damped) return {Method::dop853, Reason::damping};
  if (facts.asked == Method::bm4 && facts.dashpots) return {Method::dop853, Reason::damping};
  if (facts.asked == Method::central_difference && facts.dashpots) return {Method::leapfrog, Reason::damping};
  return {facts.asked, Reason::asked};
}

/// True if auto chooses among the other methods; backward_euler does as auto, except for impacts.
bool chosen(Method method) { return method == Method::automatic || method == Method::backward_euler; }

Plan wanting(Want want) { return {.want = want}; }

/// Plan if no obstacle is in the way, or if the method knows obstacles.
Plan plan_free(const Facts& facts, const Asked& asked, Rollback rollback) {
  const bool automatic = chosen(asked.method);
  const Method method = automatic ? Method::leapfrog : asked.method;
  const Reason reason = automatic && facts.given_step ? Reason::given_step : asked.reason;
  const bool controlled = traits(method).error_control() && !facts.given_step;
  const Steps steps = facts.counted                    ? Steps::counted
                      : automatic && !facts.given_step ? Steps::by_trials
                      : controlled                     ? Steps::controlled
                                                       : Steps::fitted;
  return {.method = method, .steps = steps, .reason = reason, .rollback = rollback};
}

/// True if explicit steps are so many that a stiff body's impacts, flights and rests are taken on their own.
bool stiff(const Facts& facts) {
  const double steps = *facts.stiffness;
  const bool many = steps > use::stiff_contact || (steps > use::stiff_contact_of_long_runs && steps * facts.length > use::long_contact);
  return many && steps < use::stiffest;
}

bool may_be_stiff(const Facts& facts, const Asked& asked) {
  return !facts.explicit_alone && (chosen(asked.method) || is_implicit(asked.method)) && !facts.given_step;
}

Plan impacts(bool rings) {
  return {.method = Method::backward_euler, .steps = Steps::impacts, .reason = Reason::stiff_contact, .rings = rings};
}

/// Plan if an obstacle is within reach: a body with internal damping takes implicit steps where they pay, a body that is not stiff takes
/// leapfrog. The modes of a flight know no internal damping, so that nothing would see the echo of an impact.
Plan plan_contact(const Facts& facts, const Asked& asked) {
  const bool own = asked.method == Method::automatic || is_implicit(asked.method);
  if (facts.dashpots && own && !facts.given_step && !facts.explicit_alone)
    return {.method = Method::sdirk2, .steps = Steps::damped, .reason = Reason::damped_contact};
  if (!facts.stiffness) return wanting(Want::stiffness);
  if (may_be_stiff(facts, asked) && stiff(facts)) {
    if (!facts.dashpots) return impacts(false);
    if (asked.method == Method::backward_euler) return {.method = asked.method, .steps = Steps::implicit, .reason = asked.reason};
  }
  const Steps steps = !facts.given_step ? Steps::doubled : facts.counted ? Steps::counted : Steps::fitted;
  return {.method = Method::leapfrog, .steps = steps, .reason = asked.method == Method::leapfrog ? asked.reason : Reason::contact};
}

}  // namespace

Plan plan(const Facts& facts) {
  const Asked wanted = asked(facts);
  if (wanted.method == Method::backward_euler && (facts.given_step || facts.pins))
    return {.method = wanted.method, .steps = Steps::implicit, .reason = wanted.reason};
  if (wanted.method == Method::sdirk2)
    return {.method = wanted.method, .steps = facts.given_step ? Steps::implicit : Steps::damped, .reason = wanted.reason};
  if (!facts.obstacles || wanted.method == Method::central_difference) return plan_free(facts, wanted, Rollback::never);
  if (facts.came_upon_obstacle) return plan_contact(facts, wanted);
  const bool in_frame = wanted.method == Method::floating_frame;  // it checks contact at the end of its steps
  if (in_frame && !facts.clear) return wanting(Want::clear);
  if (!in_frame || !*facts.clear) {
    if (!facts.within_reach) return wanting(Want::within_reach);
    if (*facts.within_reach) return plan_contact(facts, wanted);
  }
  if (chosen(wanted.method) && may_be_stiff(facts, wanted) && !facts.pins && !facts.dashpots) {  // its vibrations matter to the next impact
    if (!facts.stiffness) return wanting(Want::stiffness);
    if (stiff(facts) && !facts.rings) return wanting(Want::rings);
    if (stiff(facts) && *facts.rings) return impacts(true);
  }
  return plan_free(facts, wanted, wanted.method == Method::leapfrog ? Rollback::never : Rollback::from_obstacle);
}

bool plans_every_given_step(const Facts& facts) { return facts.obstacles && facts.counted && !resolves_contact(asked(facts).method); }

bool implicit_may_pay(double H_omega) { return H_omega > 2 * use::stiff; }

Method implicit_method(bool pins, double H_omega, bool turning_cuts) {
  return !pins && H_omega > 2 * use::stiff_turning && turning_cuts ? Method::floating_frame : Method::ros34pw2;
}

bool implicit_may_win(double work, double leapfrog_least) { return !(work > use::implicit_gain * leapfrog_least); }
bool too_loud(double vibration, double tolerance) { return !(vibration <= use::loud * tolerance); }
bool quiet(double difference, double tolerance) { return difference <= use::quiet * tolerance; }

Candidates::Candidates() : implicit_work(infinity), leapfrog(infinity), adaptive_work(infinity), bm4(infinity) {}

bool leapfrog_is_enough(const Candidates& candidates) { return !(candidates.leapfrog > use::enough * candidates.least); }

/// An implicit candidate wins if it has done the communication step within its budget. Any other candidate needs clearly less work than the
/// winner of the last trial runs.
Winner best_of(const Candidates& candidates) {
  if (candidates.implicit_work < infinity)
    return {candidates.implicit, candidates.implicit_work,
            candidates.implicit == Method::floating_frame ? Reason::free_flight : Reason::quiet_stiffness};
  Winner winner{Method::leapfrog, candidates.leapfrog, Reason::stability};
  if (leapfrog_is_enough(candidates)) return winner;
  winner.reason = Reason::least_work;
  const auto handicapped = [&](Method method, double work) { return method == candidates.before ? work : use::challenge * work; };
  const auto consider = [&](Method method, double work) {
    if (handicapped(method, work) < handicapped(winner.method, winner.work)) winner = {method, work, Reason::least_work};
  };
  consider(candidates.adaptive, candidates.adaptive_work);
  consider(Method::bm4, candidates.bm4);
  return winner;
}

}  // namespace softffd
