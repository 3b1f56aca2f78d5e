#include "kit/integrators.hpp"

#include <algorithm>

#include "contact/tolerances.hpp"
#include "flight/floating_frame.hpp"
#include "kit/thresholds.hpp"
#include "methods/backward_euler.hpp"
#include "methods/bm4.hpp"
#include "methods/central_difference.hpp"
#include "methods/dop853.hpp"
#include "methods/leapfrog.hpp"
#include "methods/rkn12.hpp"
#include "model/arithmetic.hpp"

namespace softffd {

namespace {

/// True if rounding is at most as large as the body. Farther from the origin, floating-point numbers do not resolve the body's points.
bool tells_apart(const StepContext& context) {
  const Points& x = context.run.physical.motion.x;
  return rounding * kernels::largest(x.size(), x.data()) <= context.model.body.length;  // false if a coordinate is NaN
}

}  // namespace

Integrators::Integrators(const Lattice& lattice, int planes, int pins, const Samples* samples)
    : lattice_(lattice),
      planes_(planes),
      pins_(pins),
      samples_(samples),
      implicit_work_(lattice),
      broad_phase_(lattice.points(), samples) {}

std::unique_ptr<Integrator> Integrators::make(Method method) {
  const int points = lattice_.points();
  switch (method) {
    case Method::automatic: break;  // stands for other methods
    case Method::central_difference: return std::make_unique<CentralDifference>(points);
    case Method::leapfrog: return std::make_unique<Leapfrog>(points, planes_);
    case Method::bm4: return std::make_unique<Bm4>(points, pins_);
    case Method::rkn12: return std::make_unique<Rkn12>(points, pins_);
    case Method::dop853: return std::make_unique<Dop853>(points, pins_);
    case Method::ros34pw2: return std::make_unique<Ros34pw2>(lattice_, pins_);
    case Method::backward_euler: return std::make_unique<BackwardEuler>(lattice_, planes_, pins_, samples_);
    case Method::sdirk2: return std::make_unique<Sdirk2>(static_cast<BackwardEuler&>((*this)[Method::backward_euler]));
    case Method::floating_frame: return std::make_unique<FloatingFrame>(lattice_, static_cast<Ros34pw2&>((*this)[Method::ros34pw2]));
  }
  return nullptr;
}

Count Integrators::factorizations() const {
  Count sum = 0;
  for (const auto& integrator : all_)
    if (integrator) sum += integrator->factorizations();
  return sum;
}

Outcome Integrators::take(const StepContext& context, Method method, const Span& span) {
  Outcome outcome{.status = StepStatus::too_much_work};
  if (budget_.spent()) return outcome;
  const Count& contacts = context.run.physical.exchange.contacts_resolved;
  const Count before = contacts;
  const Span within{span.origin, span.first, span.h, span.steps, span.most_work, budget_.left(), span.way, span.again};
  outcome = followed_ ? take_followed(context, method, within) : take_span(context, method, within);
  budget_.spend(std::max(outcome.work, outcome.spent) +
                double(contacts - before) * thresholds::contact_work * thresholds::patience(context.model.body.points()));
  if (outcome.status == StepStatus::ok && !tells_apart(context)) outcome.status = StepStatus::not_finite;
  if (outcome.status == StepStatus::not_finite && budget_.spent()) outcome.status = StepStatus::too_much_work;
  return outcome;
}

/// Takes the steps one at a time and passes each one to followed_.
Outcome Integrators::take_followed(const StepContext& context, Method method, const Span& span) {
  Outcome total;
  for (Count i = 0; i < span.steps && total.status == StepStatus::ok; ++i) {
    Outcome step = take_span(context, method, {span.origin, span.first + i, span.h, 1, span.most_work, span.budget, span.way, span.again});
    followed_->step(context.model.body, span.h, context.run);
    step.work += total.work;
    step.spent += total.spent;
    step.impacts += total.impacts;
    step.error = worse(total.error, step.error);
    total = step;
  }
  return total;
}

Outcome Integrators::take_span(const StepContext& context, Method method, const Span& span) {
  Integrator& integrator = (*this)[method];
  if (context.drive.planes.empty() || resolves_contact(method)) return integrator.advance(context.model, context.drive, span, context.run);
  const State& motion = context.run.physical.motion;
  Outcome total;
  for (Count i = 0; i < span.steps && total.status == StepStatus::ok; ++i) {
    x0_ = motion.x;
    v0_ = motion.v;
    const Outcome step = integrator.advance(context.model, context.drive, {span.origin, span.first + i, span.h, 1}, context.run);
    total.work += step.work;
    total.error = worse(total.error, step.error);
    if (passes(context, method, span.time(i), span.h, x0_, v0_, motion.x, motion.v)) total.status = StepStatus::contact_ahead;
  }
  if (!traits(method).error_control())
    total.work = double(span.steps) * step_work(context.model.body, context.drive, context.run, method, span.h);
  return total;
}

bool Integrators::passes(const StepContext& context, Method method, double t, double h, const Points& x0, const Points& v0, const Points& x,
                         const Points& v) {
  if (traits(method).turning == Turning::in_frame) return !off_obstacles(context.drive, t + h, x, touching * context.model.body.length);
  return broad_phase_.passed(context.drive, t, t + h, x0, v0, x, v);
}

}  // namespace softffd
