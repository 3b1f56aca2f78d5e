#include "impacts/impacts.hpp"

#include <cmath>
#include <utility>

#include "kit/implicit_steps.hpp"
#include "kit/limits.hpp"
#include "kit/snapshot.hpp"
#include "kit/thresholds.hpp"

namespace softffd {

namespace use = thresholds;

namespace {

/// Books the final error by an energy that implicit steps have taken from vibrations [J]: the velocity that it amounts to is missing.
void book_lost(const StepContext& context, const Outlook& ahead, double energy) {
  context.run.physical.error.add({ahead.along_normal * std::sqrt(2 * energy / context.model.body.mass.sum())});
}

}  // namespace

/// Takes the rest of the communication step by backward Euler, whatever that damps, if the budget is spent or the method was asked for.
StepStatus Impacts::pass_over(const Beside& at) {
  const StepContext& context = at.context;
  StiffContact& stiff = context.run.physical.stiff;
  State& motion = context.run.physical.motion;
  const Outlook ahead = outlook(context, motion);
  before_ = motion;
  stiff.begin(context.request.method == Method::backward_euler ? Phase::flight : Phase::rest);
  context.run.energy.kinetic_elastic = -1;
  const StepStatus status = run_implicit(at.integrators, context, Method::backward_euler, at.end);
  book_lost(context, ahead, std::max(0.0, energy_lost(context, before_, 0) - context.model.noise));
  context.run.control.reason = context.request.method == Method::backward_euler ? Reason::asked : Reason::stiff_contact;
  return status;
}

StepStatus Impacts::run(Integrators& integrators, const StepContext& context, double end, bool rings) {
  StiffContact& stiff = context.run.physical.stiff;
  const State& motion = context.run.physical.motion;
  Budget& budget = integrators.budget();
  Budget::Reserve reserve(budget, use::passing_over * budget.left());
  StepStatus status = StepStatus::ok;
  while (motion.time < end && status == StepStatus::ok) {
    const Beside at{integrators, context, end, step_limit(context, Method::leapfrog, false)};
    if (context.request.method == Method::backward_euler && stiff.phase != Phase::flight) {
      status = pass_over(at);
      continue;
    }
    Snapshot snapshot(context.run.physical, start_);
    switch (stiff.phase) {
      case Phase::flight: status = flights_.fly(at, rings); break;
      case Phase::impact:
      case Phase::contact: status = windows_.run(at, flights_); break;
      case Phase::rest: status = rest_.run(at); break;
    }
    rings = false;
    if (stiff.phase == Phase::flight && stiff.damped > 0)  // the body takes off
      if (const double lost = std::exchange(stiff.damped, 0); lost > context.model.noise)
        book_lost(context, outlook(context, motion), lost);
    if (status == StepStatus::too_much_work) {
      snapshot.rollback();
      snapshot.commit();
      reserve.release();
      return pass_over(at);
    }
    snapshot.commit();
  }
  return status;
}

}  // namespace softffd
