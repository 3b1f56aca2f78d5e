#include "impacts/impacts.hpp"

#include <cmath>

#include "kit/implicit_steps.hpp"
#include "kit/limits.hpp"
#include "kit/thresholds.hpp"
#include "kit/trial.hpp"

namespace softffd {

namespace use = thresholds;

/// Out of work, or as asked: what is left of the communication step is an implicit step, whatever that damps. What it takes of the energy
/// is missing in every velocity afterwards.
StepStatus Impacts::pass_over(const Beside& at) {
  const Job& job = at.job;
  StiffContact& stiff = job.run.path.stiff;
  State& motion = job.run.path.motion;
  const Outlook ahead = outlook(job, motion);
  before_ = motion;
  stiff.begin(job.request.method == Method::backward_euler ? Phase::flight : Phase::rest);
  job.run.energy.kinetic_elastic = -1;
  const StepStatus status = run_implicit(at.integrators, job, Method::backward_euler, at.end);
  const double lost = std::max(0.0, energy_lost(job, before_, 0) - job.model.noise);
  stiff.error += ahead.along_normal * std::sqrt(2 * lost / job.model.body.mass.sum());
  job.run.course.reason = job.request.method == Method::backward_euler ? Reason::asked : Reason::stiff_contact;
  return status;
}

StepStatus Impacts::run(Integrators& integrators, const Job& job, double end, bool rings) {
  StiffContact& stiff = job.run.path.stiff;
  const State& motion = job.run.path.motion;
  Budget& budget = integrators.budget();
  Budget::Reserve reserve(budget, use::passing_over * budget.left());
  StepStatus status = StepStatus::ok;
  while (motion.time < end && status == StepStatus::ok) {
    const Beside at{integrators, job, end, step_limit(job, Method::leapfrog, false)};
    if (job.request.method == Method::backward_euler && stiff.phase != Phase::flight) {
      status = pass_over(at);
      continue;
    }
    Trial trial(job.run.path, start_);
    switch (stiff.phase) {
      case Phase::flight: status = flights_.fly(at, rings); break;
      case Phase::impact:
      case Phase::contact: status = windows_.run(at, flights_); break;
      case Phase::rest: status = rest_.run(at); break;
    }
    rings = false;
    if (status == StepStatus::too_much_work) {
      trial.back();
      trial.keep();
      reserve.release();
      return pass_over(at);
    }
    trial.keep();
  }
  return status;
}

}  // namespace softffd
