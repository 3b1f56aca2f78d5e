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

/// Whether a number tells the body's points apart there: further away rounding is larger than the body.
bool tells_apart(const Job& job) {
  const Points& x = job.run.path.motion.x;
  return !in_any_part(job.model.body.springs.team(), x.size(), [&](std::ptrdiff_t i, std::ptrdiff_t end) {
    return !(rounding * kernels::largest(end - i, x.data() + i) <= job.model.body.length);  // nor where one is no number
  });
}

}  // namespace

Integrators::Integrators(const Lattice& lattice, int planes, int pins, const Samples* samples)
    : implicit_work_(lattice), reach_(lattice.points()), x0_(lattice.points(), 3), v0_(lattice.points(), 3) {
  const int points = lattice.points();
  const auto add = [&]<class T>(Method method, std::unique_ptr<T> integrator) {
    T* added = integrator.get();
    all_[std::size_t(method)] = std::move(integrator);
    return added;
  };
  add(Method::central_difference, std::make_unique<CentralDifference>(points));
  add(Method::leapfrog, std::make_unique<Leapfrog>(points, planes));
  add(Method::bm4, std::make_unique<Bm4>(points, pins));
  add(Method::rkn12, std::make_unique<Rkn12>(points, pins));
  add(Method::dop853, std::make_unique<Dop853>(points, pins));
  Ros34pw2* ros34pw2 = add(Method::ros34pw2, std::make_unique<Ros34pw2>(lattice, pins));
  add(Method::floating_frame, std::make_unique<FloatingFrame>(lattice, *ros34pw2));
  BackwardEuler* backward_euler = add(Method::backward_euler, std::make_unique<BackwardEuler>(lattice, planes, pins, samples));
  add(Method::sdirk2, std::make_unique<Sdirk2>(*backward_euler));
  backward_euler_ = backward_euler;
  ros34pw2_ = ros34pw2;
}

Integrators::Integrators(Integrators&&) noexcept = default;
Integrators::~Integrators() = default;

Count Integrators::factorizations() const { return ros34pw2_->factorizations() + backward_euler_->factorizations(); }

Outcome Integrators::take(const Job& job, Method method, const Span& span) {
  Outcome outcome{.status = StepStatus::too_much_work};
  if (budget_.spent()) return outcome;
  const Count& contacts = job.run.path.exchange.contacts_resolved;
  const Count before = contacts;
  outcome = take_span(job, method, {span.origin, span.first, span.h, span.steps, span.most_work, budget_.left(), span.way, span.again});
  budget_.spend(std::max(outcome.work, outcome.spent) +
                double(contacts - before) * thresholds::contact_work * thresholds::patience(job.model.body.points()));
  if (outcome.status == StepStatus::ok && !tells_apart(job)) outcome.status = StepStatus::not_finite;
  if (outcome.status == StepStatus::not_finite && budget_.spent()) outcome.status = StepStatus::too_much_work;
  return outcome;
}

Outcome Integrators::take_span(const Job& job, Method method, const Span& span) {
  Integrator& integrator = (*this)[method];
  if (job.drive.planes.empty() || resolves_contact(method)) return integrator.advance(job.model, job.drive, span, job.run);
  const State& motion = job.run.path.motion;
  Outcome total;
  for (Count i = 0; i < span.steps && total.status == StepStatus::ok; ++i) {
    x0_ = motion.x;
    v0_ = motion.v;
    const Outcome step = integrator.advance(job.model, job.drive, {span.origin, span.first + i, span.h, 1}, job.run);
    total.work += step.work;
    total.error = worse(total.error, step.error);
    if (passes(job, method, span.time(i), span.h, x0_, v0_, motion.x, motion.v)) total.status = StepStatus::contact_ahead;
  }
  if (!traits(method).error_control()) total.work = double(span.steps) * step_work(job.model.body, method, span.h);
  return total;
}

bool Integrators::passes(const Job& job, Method method, double t, double h, const Points& x0, const Points& v0, const Points& x,
                         const Points& v) {
  if (traits(method).turning == Turning::in_frame) return !off_obstacles(job.drive, t + h, x, touching * job.model.body.length);
  return reach_.passed(job.drive, t, t + h, x0, v0, x, v);
}

}  // namespace softffd
