/// Leapfrog through contact with steps that follow the tolerance: impacts spoil what was true a moment ago, so that every stretch is its
/// own trial. It is run twice, with h and h / 2, and the finer run counts; where that differs too much, again with smaller steps.
#include <algorithm>

#include "methods/traits.hpp"
#include "model/arithmetic.hpp"
#include "stepping/propagator.hpp"

namespace softffd {

namespace {

/// Steps of the coarser run in a stretch.
constexpr Count stretch_steps = 24;
/// A stretch is run again if its error is this many times what it may be; a single one may exceed its share.
constexpr double too_much = 4;
/// Where contact makes the difference jump, the step is not cut below this share of the stable one.
constexpr double least_share = 1.0 / 1000;
/// Stretches that may be run once after a success.
constexpr double shortest_trust = 8, longest_trust = 128;

}  // namespace

StepStatus Propagator::run_doubled(const Job& job, double end) {
  State& state = job.state;
  Course& course = job.course;
  Exchange& exchange = job.exchange;
  ContactSteps& contact = course.contact;
  const double allowed = forecast_share * job.request.tolerance * power(job.request.share, 2);
  const auto run = [&](double h, Count steps, State& moved, Exchange& received) {
    course.work += double(steps) * traits(Method::leapfrog).work;
    return take_steps(job, Method::leapfrog, {state.time, 0, h, steps}, moved, received);
  };
  Count done = 0;
  while (state.time < end) {
    const double limit = step_limit(job, Method::leapfrog, false), left = end - state.time;
    double h = contact.h > 0 ? std::min(contact.h, limit) : limit;
    if (!(left / h <= double(most_steps)) || done > most_steps) return refusal(left / h);
    const bool at_limit = h == limit;
    start_ = state;
    start_exchange_ = exchange;
    Count impacts = leapfrog_.impacts();
    for (int tries = 0;; ++tries) {
      const Count total = divisions(left, h), steps = std::min(total, stretch_steps);
      const double part = left / double(total), next = steps == total ? end : start_.time + double(steps) * part;
      course.clock = {start_.time, part, 0};
      if (at_limit && tries == 0 && contact.free > 0) {
        const StepStatus status = run(part, steps, state, exchange);
        if (status != StepStatus::ok) return status;
        const bool impact = leapfrog_.impacts() != impacts;
        if (!impact || contact.impact > 0) {
          --(impact ? contact.impact : contact.free);
          done += steps;
          state.time = next;
          break;
        }
        course.rejected += steps;
        state = start_;
        exchange = start_exchange_;
        impacts = leapfrog_.impacts();
      }
      coarse_ = state;
      StepStatus status = run(part, steps, coarse_, scratch_);
      if (status == StepStatus::ok) status = run(0.5 * part, 2 * steps, state, exchange);
      if (status != StepStatus::ok) return status;
      const double error = growing(job, coarse_, state, double(steps) * part) / 3, least = least_share * limit;
      const double factor = error > 0 ? 0.9 * std::sqrt(allowed / error) : 2.0;
      if (error <= too_much * allowed || part <= least || tries == 4) {
        const bool impact = leapfrog_.impacts() != impacts;
        Count &trust = impact ? contact.impact : contact.free, &next_trust = impact ? contact.impact_next : contact.free_next;
        const bool good = at_limit && tries == 0 && 4 * error <= 0.5 * allowed;  // 4: of the coarser run
        trust = good ? next_trust : 0;
        next_trust = good ? std::min(2 * next_trust, Count(std::clamp(allowed / error, shortest_trust, longest_trust))) : 1;
        contact.h = std::max(part * std::clamp(factor, 0.5, 1.5), least);
        course.clock.h = 0.5 * part;
        done += 2 * steps;
        state.time = next;
        break;
      }
      course.rejected += 2 * steps;
      state = start_;
      exchange = start_exchange_;
      impacts = leapfrog_.impacts();
      h = std::max(part * std::clamp(factor, 0.2, 0.7), least);
    }
  }
  course.steps += done;
  return StepStatus::ok;
}

}  // namespace softffd
