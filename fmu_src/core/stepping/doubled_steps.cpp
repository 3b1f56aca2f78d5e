#include "stepping/doubled_steps.hpp"

#include <algorithm>
#include <cmath>

#include "model/arithmetic.hpp"
#include "stepping/limits.hpp"
#include "stepping/thresholds.hpp"
#include "stepping/trial.hpp"

namespace softffd {

namespace {

namespace use = thresholds;

/// Whether the next stretches may be run once, after one that was run twice at the largest stable step with this error.
void learn_trust(ContactSteps& contact, bool impact, bool good, double allowed, double error) {
  Count &trust = impact ? contact.impact : contact.free, &next = impact ? contact.impact_next : contact.free_next;
  trust = good ? next : 0;
  next = good ? std::min(2 * next, Count(std::clamp(allowed / error, use::shortest_trust, use::longest_trust))) : 1;
}

}  // namespace

StepStatus DoubledSteps::run(Integrators& integrators, const Job& job, double end) {
  const State& motion = job.run.path.motion;
  Count taken = 0;
  while (motion.time < end) {
    const double limit = step_limit(job, Method::leapfrog, false), left = end - motion.time, known = job.run.course.contact.h;
    const double h = known > 0 ? tighter(known, limit) : limit;
    if (!(left / h <= double(use::most_steps)) || taken > use::most_steps) return refusal(left / h);
    const StepStatus status = run_stretch(integrators, job, {limit, h, end}, taken);
    if (status != StepStatus::ok) return status;
  }
  job.run.path.steps += taken;
  return StepStatus::ok;
}

StepStatus DoubledSteps::run_stretch(Integrators& integrators, const Job& job, Stretch stretch, Count& taken) {
  Path& path = job.run.path;
  Course& course = job.run.course;
  ContactSteps& contact = course.contact;
  const double allowed = use::forecast_tolerance * job.request.tolerance * power(job.request.step_factor, 2);
  const double least = use::least_doubled * stretch.limit;
  const bool at_limit = stretch.at_limit();
  Trial trial(path, start_);
  const double begin = path.motion.time, left = stretch.end - begin;
  const auto run = [&](double h, Count steps) {
    const Outcome outcome = integrators.take(job, Method::leapfrog, {begin, 0, h, steps});
    course.work += outcome.work;
    return outcome;
  };
  double h = stretch.h;
  for (int tries = 0;; ++tries) {
    const Count total = divisions(left, h), steps = std::min(total, use::stretch_steps);
    const double part = left / double(total), next = steps == total ? stretch.end : begin + double(steps) * part;
    path.clock = {begin, part, 0};
    if (at_limit && tries == 0 && contact.free > 0) {
      const Outcome once = run(part, steps);
      if (once.status != StepStatus::ok) return once.status;
      const bool impact = once.impacts > 0;
      if (!impact || contact.impact > 0) {
        --(impact ? contact.impact : contact.free);
        taken += steps;
        path.motion.time = next;
        trial.keep();
        return StepStatus::ok;
      }
      course.rejected += steps;
      trial.back();
    }
    const Outcome coarse = run(part, steps);
    if (coarse.status != StepStatus::ok) return coarse.status;
    std::swap(coarse_, path.motion);
    trial.back();
    const Outcome fine = run(0.5 * part, 2 * steps);
    if (fine.status != StepStatus::ok) return fine.status;
    const double error = growing(job, coarse_, path.motion, double(steps) * part) / 3;
    const double factor = error > 0 ? use::safety * std::sqrt(allowed / error) : use::doubled_growth;
    const bool last = part <= least || tries == use::most_reruns;
    if (last && !std::isfinite(error)) return StepStatus::not_finite;
    if (error <= use::too_much * allowed || last) {
      const bool good = at_limit && tries == 0 && 4 * error <= use::trusted * allowed;  // 4: of the coarser run
      learn_trust(contact, coarse.impacts + fine.impacts > 0, good, allowed, error);
      contact.h = std::max(part * std::clamp(factor, use::next_shrink, use::next_growth), least);
      path.clock = {begin, 0.5 * part, 0};
      taken += 2 * steps;
      path.motion.time = next;
      trial.keep();
      return StepStatus::ok;
    }
    course.rejected += 2 * steps;
    trial.back();
    h = std::max(part * std::clamp(factor, use::rerun_shrink, use::rerun_growth), least);
  }
}

}  // namespace softffd
