/// The propagator's runs of internal steps: a given step counted, a fitted one, and steps under error control.
#include <algorithm>
#include <cmath>
#include <limits>

#include "methods/traits.hpp"
#include "model/arithmetic.hpp"
#include "stepping/propagator.hpp"

namespace softffd {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
/// Internal steps between two looks at the deformation.
constexpr Count look_every = 8;

/// Cuts the internal steps of the unit that has begun into so many.
void refine(Clock& clock, Count times) {
  const Count into = clock.count % clock.parts, parts = clock.parts * times;
  clock = {clock.origin + double(clock.count - into) * clock.h, clock.unit / double(parts), into * times, clock.unit, parts};
}

}  // namespace

/// Looks are counted, so that they fall on the same moments however the time is cut. What a look says of a divided step holds from the
/// next unit on, or at once if it must be finer. A step that has to be divided gets the distance from the limit that automatic ones keep;
/// close to it every vibration would change the division, and feed itself by that.
StepStatus Propagator::run_counted(const Job& job, Method method, Count units) {
  Clock& clock = job.course.clock;
  const double unit = job.request.step;
  while (units > 0) {
    const Count into = clock.unit == unit ? clock.count % clock.parts : 0;
    const bool begins_divided = into == 0 && clock.parts > 1;
    if (clock.unit != unit || job.course.bound < 0 || clock.count % look_every == 0 || begins_divided || job.request.share < 1) {
      const double wanted = unit * job.request.share, limit = std::min(wanted, step_limit(job, method, true));
      const bool again = job.request.share < 1;  // without a result so far: as divided as it must be, anew at every unit
      const double target = limit < wanted && !again ? std::min(limit, step_limit(job, method, false)) : limit;
      if (!(unit / target <= double(most_steps))) return refusal(unit / target);
      const bool too_long = divisions(clock.h, limit) > 1;
      if (into == 0 && (clock.unit != unit || too_long || again || target > 1.25 * clock.h)) {
        const Count parts = divisions(unit, target);
        clock = {job.state.time, unit / double(parts), 0, unit, parts};
      } else if (too_long) {
        refine(clock, divisions(clock.h, target));
      }
    }
    if (double(units) * double(clock.parts) > double(most_steps)) return StepStatus::too_many_steps;
    const Count left = clock.parts > 1 ? clock.parts - clock.count % clock.parts : units;
    const Count ahead = std::min(left, look_every - clock.count % look_every);
    const StepStatus status = run_stretch(job, method, clock.h, ahead);
    if (status != StepStatus::ok) return status;
    job.state.time = clock.time();
    if (clock.parts == 1)
      units -= ahead;
    else if (clock.count % clock.parts == 0)
      --units;
  }
  return StepStatus::ok;
}

StepStatus Propagator::run_fitted(const Job& job, Method method, double end, double pause_at) {
  const auto& [equations, request, state, course, exchange] = job;
  const bool given = request.step > 0;
  const bool stable_only = method == Method::central_difference && !equations.around.planes.empty();  // its contact does not converge
  Calibration& calibration = method == Method::bm4 ? course.bm4 : course.leapfrog;
  Clock& clock = course.clock;
  Count steps = 0;
  while (true) {
    if (stable_only)
      calibration.h = infinity;
    else if (!given && calibration_due(job, calibration, end - state.time, request.jolt && steps == 0))
      calibrate(job, method, end - state.time, 4);
    const double limit = std::min(step_limit(job, method, given), request.share * (given ? request.step : calibration.h));
    if (steps == 0 || clock.h > limit || limit > 1.25 * clock.h) {
      const double left = end - state.time;
      if (!(left / limit <= double(most_steps))) return refusal(left / limit);
      steps = divisions(left, limit);
      clock = {state.time, left / double(steps), 0};
    }
    const Count ahead = std::min(steps, look_every);
    const StepStatus status = run_stretch(job, method, clock.h, ahead);
    if (status != StepStatus::ok) return status;
    steps -= ahead;
    state.time = steps == 0 ? end : clock.time();
    if (steps == 0 || course.work >= pause_at) return StepStatus::ok;
  }
}

StepStatus Propagator::run_stretch(const Job& job, Method method, double h, Count steps) {
  const Span span{job.course.clock.origin, job.course.clock.count, h, steps};
  job.course.clock.count += steps;
  job.course.steps += steps;
  job.course.work += double(steps) * traits(method).work;
  return take_steps(job, method, span, job.state, job.exchange);
}

StepStatus Propagator::take_steps(const Job& job, Method method, const Span& span, State& state, Exchange& exchange) {
  const Equations& equations = job.equations;
  const auto& [body, around] = equations;
  const bool watch = job.request.watch, planes = !around.planes.empty();
  if (method == Method::central_difference) return central_difference_.advance(body, around, span, watch, state, exchange);
  if (method == Method::leapfrog) return leapfrog_.advance(body, around, span, watch, state, exchange);
  for (Count i = 0; i < span.steps; ++i) {
    const double t = span.time(i);
    if (planes) x0_ = state.x, v0_ = state.v;
    if (method == Method::bm4) {
      bm4_.step(equations, t, span.h, watch, state, exchange);
    } else {
      job.course.factored.h = 0;  // nobody looks at the error of a given step: an old factor could spoil it
      attempt({equations, job.request, state, job.course, exchange}, method, t, span.h);
      accept(controlled(method), equations, state, exchange);
    }
    if (planes && passes(equations, method, t, span.h, x0_, v0_, state.x, state.v)) return StepStatus::contact_ahead;
  }
  return StepStatus::ok;
}

void Propagator::accept(OneStep& trial, const Equations& equations, State& state, Exchange& exchange) {
  state.x.swap(trial.x);
  state.v.swap(trial.v);
  equations.body.internal_force(state.x, state.spring);
  if (trial.ledger.recording()) trial.ledger.settle(exchange);
}

OneStep& Propagator::controlled(Method method) {
  if (method == Method::ros34pw2) return *ros34pw2_;
  if (method == Method::floating_frame) return *floating_frame_;
  return method == Method::rkn12 ? static_cast<OneStep&>(rkn12_) : dop853_;
}

/// Tries a step of a method with error control; returns its error [m].
double Propagator::attempt(const Job& job, Method method, double t, double h) {
  OneStep& trial = controlled(method);
  trial.ledger.open(job.equations, job.request.watch, method == Method::floating_frame);
  if (!is_implicit(method)) {
    job.course.work += traits(method).work;
    return trial.attempt(job.equations, t, h, job.state);
  }
  Factored& factored = ros34pw2_->factored = job.course.factored;
  const bool in_frame = method == Method::floating_frame;
  if (factored.in_frame != in_frame) factored.in_frame = in_frame, factored.h = 0;
  const double error = trial.attempt(job.equations, t, h, job.state);
  job.course.factored = factored;
  const bool made = job.course.factored.uses == 1;  // not whether it was made now: after a restore it is made again
  job.course.factors += made;
  job.course.work += implicit_.step + (made ? implicit_.factor : 0) + (in_frame ? implicit_.frame : 0);
  return error;
}

double& Propagator::controlled_step(Course& course, Method method) {
  if (method == Method::floating_frame) return course.floating_frame;
  return method == Method::rkn12 ? course.rkn12 : method == Method::dop853 ? course.dop853 : course.ros34pw2;
}

StepStatus Propagator::run_controlled(const Job& job, Method method, double end, double pause_at) {
  const auto& [equations, request, state, course, exchange] = job;
  OneStep& trial = controlled(method);
  double& h = controlled_step(course, method);
  const bool planes = !equations.around.planes.empty();
  const double forgets = std::min(request.horizon, memory_.maxCoeff());
  const double rounding = 1e-15 * std::max(equations.body.length, kernels::largest(state.x.size(), state.x.data()));
  const double tightened = request.tolerance * power(request.share, traits(method).order);
  const auto tolerance = [&, t = traits(method)](double step) {
    return std::max(rounding, std::min(t.largest_share, t.summed_share * step / forgets) * tightened);
  };
  const double least = 1e-14 * std::max(std::abs(end), end - state.time);
  double limit = step_limit(job, method, false);
  // In the frame the first step is as long as may be: short ones would follow the vibrations that it is to pass over.
  const bool short_first = stability_.elastic() && method != Method::floating_frame;
  if (!(h > 0)) h = request.share * std::min(end - state.time, short_first ? 3 / bound(job) : infinity);
  course.clock = {state.time, h, 0};
  const double begun = course.work;
  for (Count tries = 1; state.time < end; ++tries) {
    if (course.work - begun > double(most_steps)) return StepStatus::too_many_steps;
    const double left = end - state.time;
    const Count ahead = divisions(left, std::min(h, limit));  // equal parts, so that no sliver is left at the end
    const double step = ahead == 1 ? left : left / double(ahead);
    if (!(step > least)) return StepStatus::not_finite;
    const double error = attempt(job, method, state.time, step) / tolerance(step);
    const bool turned = method == Method::ros34pw2 && step > 2 * turning_limit(job, trial.x, trial.v);
    if (method == Method::ros34pw2) limit = step_limit(job, method, false);
    const double factor = turned ? 0.5 : error > 0 ? 0.9 * root(1 / error, trial.exponent, 0.1, 6) : error == 0 ? 5 : 0.1;
    if (!(error <= 1) || turned) {
      ++course.rejected;
      const bool old_factor = is_implicit(method) && course.factored.uses > 1;
      if (old_factor) course.factored.h = 0;
      h = step * (old_factor ? std::clamp(factor, 0.5, 0.95) : std::min(factor, 0.9));
      if (method == Method::floating_frame && course.work >= pause_at) return StepStatus::ok;
      continue;
    }
    // A step that the communication point has cut short says that it can be longer only as far as it was tried.
    const bool keep = is_implicit(method) && factor > 0.95 && factor < 1.5;  // and with the step the factor
    if (!keep && (factor * step > h || (factor < 5 && step > 0.2 * h))) h = step * factor;
    if (planes && passes(equations, method, state.time, step, state.x, state.v, trial.x, trial.v)) return StepStatus::contact_ahead;
    accept(trial, equations, state, exchange);
    ++course.steps;
    course.clock.h = step;
    state.time = ahead == 1 ? end : state.time + step;
    if (course.work >= pause_at) return StepStatus::ok;
    if (tries % look_every == 0 && deformed_since_bound(job)) limit = step_limit(job, method, false);
  }
  return StepStatus::ok;
}

/// Does a step go behind an obstacle? In the frame the end decides, as it does for the implicit contact step, which would take over.
bool Propagator::passes(const Equations& equations, Method method, double t, double h, const Points& x0, const Points& v0, const Points& x,
                        const Points& v) {
  const auto& [body, around] = equations;
  if (method == Method::floating_frame) return !reach_.clear(body, around, t + h, x);
  return reach_.passed(around, t, t + h, x0, v0, x, v);
}

}  // namespace softffd
