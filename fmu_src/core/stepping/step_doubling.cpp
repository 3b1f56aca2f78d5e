#include "stepping/step_doubling.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kit/limits.hpp"
#include "kit/outlook.hpp"
#include "kit/snapshot.hpp"
#include "kit/thresholds.hpp"
#include "machine/elementary.hpp"
#include "methods/damped_leapfrog.hpp"
#include "model/arithmetic.hpp"

namespace softffd {

namespace thresholds {

/// Multiple of the tolerance that the summed errors may take by forecast, for contact of a surface [1]. Errors of its sub-intervals point
/// the same way, as in rolling.
constexpr double surface_tolerance = 0.6;
/// The same if vertices of the surface strike, whose errors point now this way, now that way.
constexpr double rattling_tolerance = 1;
/// The same for contact of a body with internal damping, whose errors add to those of implicit steps.
constexpr double damped_tolerance = 0.5;
/// If the error is below this multiple of the allowed error, one rerun with a shorter step suffices to conclude that shorter steps do not
/// reduce it [1].
constexpr double soon_believed = 16;
/// Largest number of reruns of a sub-interval.
constexpr int most_reruns = 4;
/// Bounds of the number of sub-intervals that may be run once after a success. By experience on dropped and sliding bodies, as all here.
constexpr double shortest_trust = 8, longest_trust = 128;
/// Fraction of the allowed error that the coarser run may have to keep that trust, and to be trusted at all [1]: a change of the step may
/// make a vibration larger by a third, and a vibration that lost the trust by that would never come to rest.
constexpr double trusted = 0.5, trusted_at_first = 0.125;
/// A sub-interval with an impact is followed by a neighbour, whatever touched before, if its final error is above this fraction of the
/// tolerance [1]: velocities at its end, in the midst of the impact, differ by more than what lasts.
constexpr double noticed = 0.3;
/// Factor of the step [1]: upper bound after a sub-interval (the lower one is in kit/thresholds.hpp), bounds before a rerun, value for no
/// error.
constexpr double next_growth = 1.5, rerun_shrink = 0.2, rerun_growth = 0.7, doubled_growth = 2;

}  // namespace thresholds

namespace {

namespace use = thresholds;

/// Multiple of the tolerance that the summed errors of sub-intervals may take by forecast. rattles: in the sub-interval vertices strike
/// after a landing, or come and go as those of a damped body do.
double forecast_factor(const Body& body, bool rattles) {
  if (rattles) return use::rattling_tolerance;
  return body.samples ? use::surface_tolerance : body.dashpots() ? use::damped_tolerance : use::forecast_tolerance;
}

/// Decides whether the next sub-intervals may be run once, after one that was run twice at the largest stable step with this error.
void learn_trust(ContactSteps& contact, bool impact, bool good, double allowed, double error) {
  Count &trust = impact ? contact.impact : contact.free, &next = impact ? contact.impact_next : contact.free_next;
  trust = good ? next : 0;
  next = good ? std::min(2 * next, Count(std::clamp(allowed / error, use::shortest_trust, use::longest_trust))) : 1;
}

/// Factor of the step.
double factor_after(double allowed, double error) { return error > 0 ? use::safety * std::sqrt(allowed / error) : use::doubled_growth; }

/// True if shorter steps have reduced the error of a sub-interval by less than half an order would. Two runs then differ by what no step
/// resolves, as by which of several places strikes first, or by how contact constraints that depend on each other share friction. soon: one
/// shorter step may tell. Otherwise, for an impact or a body with internal damping, a larger error counts only after more tries.
bool in_vain(const TriedStretch& tried, const TriedStretch& now, double allowed, int tries, bool soon) {
  if (!(now.h < tried.h && now.impact == tried.impact && now.error > tried.error * std::sqrt(now.h / tried.h))) return false;
  return tries > 1 || now.error <= (soon ? use::soon_believed : use::too_much) * allowed;
}

/// Returns the next step after a sub-interval that is accepted. wanted: error that was to be met [m].
double step_after(const TriedStretch& done, double wanted, double least) {
  return std::max(done.h * std::clamp(factor_after(wanted, done.error), use::next_shrink, use::next_growth), least);
}

/// Chooses the next step for a surface, of which more vertices may touch than there are control points. An impact does not make the step
/// shorter; rattling may make it longer.
void choose_step(ContactSteps& contact, const TriedStretch& done, bool rattles, double wanted, bool vain, double least) {
  TriedStretch& tried = contact.tried;
  ErrorFloor& floor = contact.floor;
  const TriedStretch before = std::exchange(tried, {});
  if (done.impact) {
    contact.h = std::max({done.h, before.impact ? before.h : 0, rattles ? step_after(done, wanted, least) : 0});
    return;
  }
  if (vain) {
    contact.h = std::max(before.h, use::next_growth * done.h);
    floor = {done.error, floor.next, std::min(2 * floor.next, Count(use::longest_trust))};
    return;
  }
  if (floor.left > 0)
    floor = {std::min(floor.error, done.error), floor.left - 1, floor.next};
  else
    floor = {};
  contact.h = step_after(done, wanted, least);
  if (before.impact && done.h < before.h)
    tried = before;  // the impact is still to come
  else if (contact.h < done.h)
    tried = done;
}

/// Largest recent error, if steps of h had been taken: of this sub-interval, and of those before that make it a whole one. Where
/// communication steps are shorter than a sub-interval, each sees only a part of a vibration. If each part had its own step, the steps
/// would swing with the vibration and feed it, because what leapfrog keeps of a vibration's energy depends on the step.
double of_late(ContactSteps& contact, double error, double h, Count steps) {
  contact.largest = std::max(contact.largest, error / (h * h));
  contact.seen += steps;
  const bool whole = contact.seen >= use::stretch_steps;
  const double largest = whole ? contact.largest : std::max(contact.largest, contact.largest_seen);
  if (whole) {
    contact.largest_seen = contact.largest;
    contact.largest = 0;
    contact.seen = 0;
  }
  return std::max(error, largest * h * h);
}

/// Returns the step of the coarser run, at most `longest`. The kicks of both runs contain the reactions of obstacles, or those of neither:
/// otherwise the runs differ by that, which tells nothing of the finer one's error.
double of_one_kind(const Body& body, double longest) {
  const double contains = DampedLeapfrog::longest_with_reactions(body);
  return body.dashpots() && contains < longest && 0.5 * longest <= contains ? contains : longest;
}

}  // namespace

StepStatus StepDoubling::run(Integrators& integrators, const StepContext& context, double end, double most) {
  const Body& body = context.model.body;
  const State& motion = context.run.physical.motion;
  const double begin = motion.time, least_left = most < infinity ? integrators.budget().left() - most : -infinity;
  Count taken = 0;
  while (motion.time < end && integrators.budget().left() >= least_left) {
    const double limit = of_one_kind(body, step_limit(context, Method::leapfrog, false)), left = end - motion.time;
    const double known = context.run.control.contact.h, h = known > 0 ? of_one_kind(body, tighter(known, limit)) : limit;
    const double work = left / limit * step_work(body, context.drive, context.run, Method::leapfrog, limit);
    if (!integrators.budget().covers(work)) return refusal(work);
    const StepStatus status = run_stretch(integrators, context, {limit, h, end, motion.time == begin}, taken);
    if (status != StepStatus::ok) return status;
  }
  context.run.physical.steps += taken;
  return StepStatus::ok;
}

StepStatus StepDoubling::run_stretch(Integrators& integrators, const StepContext& context, Stretch stretch, Count& taken) {
  PhysicalState& physical = context.run.physical;
  ControllerState& control = context.run.control;
  ContactSteps& contact = control.contact;
  const Body& body = context.model.body;
  const double least = shortest_in_contact(context, stretch.limit);
  const bool at_limit = stretch.at_limit();
  Snapshot snapshot(physical, start_);
  const Count& contacts = physical.exchange.contacts_resolved;
  const Count contacts_before = contacts;
  const double begin = physical.motion.time, left = stretch.end - begin;
  const bool follows = Landings::landing(context, begin);
  const auto run = [&](double h, Count steps) {
    const Outcome outcome = integrators.take(context, Method::leapfrog, {begin, 0, h, steps});
    control.work += outcome.work;
    return outcome;
  };
  double h = stretch.h;
  for (int tries = 0;; ++tries) {
    const Count total = divisions(left, h), steps = std::min(total, use::stretch_steps);
    const double part = left / double(total), next = steps == total ? stretch.end : begin + double(steps) * part;
    physical.clock = {begin, part, 0};
    const auto follow = [&](bool impact, const FinalError& leaves, bool anyway) {
      landings_.follow(integrators, context, start_.motion, Method::leapfrog, {begin, 0, part, steps}, impact, 0, anyway);
      if (!follows && !Landings::landing(context, physical.motion.time)) physical.error.add(leaves);
    };
    if (at_limit && tries == 0 && contact.free > 0) {
      const Outcome once = run(part, steps);
      if (once.status != StepStatus::ok) return once.status;
      const bool impact = once.impacts > 0, touches = contacts > contacts_before;
      if (impact ? contact.impact > 0 : touches <= contact.touches) {
        contact.touches = touches && (contact.touches || !impact);
        --(impact ? contact.impact : contact.free);
        taken += steps;
        physical.motion.time = next;
        follow(impact, contact.final_error, false);
        snapshot.commit();
        return StepStatus::ok;
      }
      control.rejected += steps;
      snapshot.rollback();
    }
    const Outcome coarse = run(part, steps);
    if (coarse.status != StepStatus::ok) return coarse.status;
    std::swap(coarse_, physical.motion);
    snapshot.rollback();
    const Outcome fine = run(0.5 * part, 2 * steps);
    if (fine.status != StepStatus::ok) return fine.status;
    const bool impact = coarse.impacts + fine.impacts > 0;
    const bool strikes = impact && body.samples;
    const bool lands = strikes && !follows && in_flight(context, begin, start_.motion.x);
    const bool rattles = (strikes && !lands) || (body.samples && follows && body.dashpots());
    const double allowed = forecast_factor(body, rattles) * context.request.tolerance * power(context.request.step_factor, 2);
    const double stretch_time = double(steps) * part, of_difference = strikes || rattles ? 1 : 1.0 / 3;  // error of the finer run
    const FinalError leaves =
        final_error(context, coarse_, physical.motion, outlook(context, physical.motion), rattles ? stretch_time : 0).times(of_difference);
    const double by_end =
        rattles ? scattered(context, coarse_, physical.motion, stretch_time) : growing(context, coarse_, physical.motion, stretch_time);
    const double error = strikes || rattles ? worse(by_end, leaves.size) : of_difference * by_end;
    const TriedStretch tried{part, error, impact};
    const bool vain =
        body.samples && error > allowed && (part <= least || in_vain(contact.tried, tried, allowed, tries, !impact && !body.dashpots()));
    const bool floored = contact.floor.left > 0 && !impact && contact.floor.error > allowed;
    const double wanted = floored ? contact.floor.error : allowed;
    const bool last = vain || part <= least || tries == use::most_reruns;
    if (last && !std::isfinite(error)) return StepStatus::not_finite;
    if (error <= use::too_much * wanted || last) {
      contact.final_error.learn(leaves.times(4));
      contact.touches = contacts > contacts_before && (contact.touches || !impact);
      const bool cut = stretch.first && steps == total;
      const double worst = cut ? of_late(contact, error, part, steps) : error;
      const double trusted = contact.free_next > 1 ? use::trusted : use::trusted_at_first;
      const bool good = at_limit && tries == 0 && 4 * worst <= trusted * allowed;  // 4: error of the coarser run
      learn_trust(contact, impact, good, allowed, worst);
      if (body.samples)
        choose_step(contact, {part, worst, impact}, rattles, wanted, vain, least);
      else
        contact.h = step_after({part, worst}, allowed, least);
      physical.clock = {begin, 0.5 * part, 0};
      taken += 2 * steps;
      physical.motion.time = next;
      follow(impact, leaves, leaves.size > use::noticed * context.request.tolerance);
      snapshot.commit();
      return StepStatus::ok;
    }
    control.rejected += 2 * steps;
    if (body.samples) contact.tried = tried;
    snapshot.rollback();
    h = std::max(part * std::clamp(factor_after(wanted, error), use::rerun_shrink, use::rerun_growth), least);
  }
}

}  // namespace softffd
