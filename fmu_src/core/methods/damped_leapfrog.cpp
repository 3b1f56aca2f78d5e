#include "methods/damped_leapfrog.hpp"

#include "methods/traits.hpp"

namespace softffd {

namespace {

/// Length of a half kick times the fastest rate of damping up to which one explicit step of it is stable.
constexpr double explicit_kick = 2;

/// Pinned points at the end of the drift are where the frame is. What the kick gave them is less than what moves them there by the impulse
/// of their pin.
void drift_pins(const StepView& step, Points& v, Points& x1, Exchange& exchange) {
  for (std::size_t a = 0; a < step.around.pins.size(); ++a) {
    const Pin& pin = step.around.pins[a];
    const Frame start = pin.at(step.t0), end = pin.at(step.t1);
    for (std::size_t n = 0; n < pin.points.size(); ++n) {
      const int p = pin.points[n];
      const Vec3 arm = start.arm(pin.local[n]), here = end.origin + end.arm(pin.local[n]), velocity = (here - row(step.x0, p)) / step.h;
      exchange.push(exchange.pins[a], step.body.mass[p] * (velocity - row(v, p)), arm, 0.5 * (start.material_velocity(arm) + velocity));
      set_row(x1, p, here);
      set_row(v, p, velocity);
    }
  }
}

/// After the closing half kick, which found them with the velocity of the frame, they have it again. middle: velocities before the kick.
void close_pins(const StepView& step, const Points& middle, Points& v, Exchange& exchange) {
  step.around.visit_pinned(step.t1, [&](const PinnedPoint& held) {
    const int p = held.point;
    const Vec3 old = row(middle, p), velocity = held.velocity();
    const Vec3 impulse = step.body.mass[p] * ((velocity - old) + (velocity - row(v, p)));
    exchange.push(exchange.pins[held.pin], impulse, held.arm, 0.5 * (old + velocity));
    set_row(v, p, velocity);
  });
}

}  // namespace

DampedLeapfrog::DampedLeapfrog(int points, int planes)
    : masses_(points), kick_(points), contact_(points, planes), reactions_(points, planes) {
  for (Points* each : {&before_, &middle_, &next_, &force_, &inner_, &acting_}) each->setZero(points, 3);
}

Outcome DampedLeapfrog::advance(const Model& model, const Drive& drive, const Span& span, Run& run) {
  const Count before = contact_.impacts();
  masses_.prepare(model.body, span.h);
  kick_.prepare(model.body, 0.5 * span.h);
  contact_.begin(drive, span.time(0), span.h);
  resolved_ = 0.5 * span.h * model.body.fastest_damping <= explicit_kick;
  Outcome outcome{.work = double(span.steps) * step_work(model.body, Method::leapfrog, span.h)};
  for (Count i = 0; i < span.steps && outcome.status == StepStatus::ok; ++i)
    outcome.status = step(model.body, drive, span, i, run.path.motion, run.path.exchange);
  outcome.impacts = contact_.impacts() - before;
  return outcome;
}

StepStatus DampedLeapfrog::step(const Body& body, const Drive& around, const Span& span, Count i, State& state, Exchange& exchange) {
  const double t0 = span.time(i), t1 = span.time(i + 1);
  const StepView view{body, masses_, around, inner_, force_, state.x, t0, t1, span.h};
  around.force_at(t0, force_);
  const StepStatus status = open(view, state, exchange);
  if (status != StepStatus::ok) return status;
  if (around.watch && around.ramped) exchange.work += around.ramp_dot(0.5 * (t0 + t1), next_ - state.x);
  state.x.swap(next_);
  body.internal_force(state.x, state.spring);
  around.force_at(t1, force_);
  return close(view, state, exchange);
}

StepStatus DampedLeapfrog::open(const StepView& view, State& state, Exchange& exchange) {
  const bool planes = !view.around.planes.empty();
  before_.swap(state.v);
  prepare_kick(view, state, view.h);
  if (planes && resolved_) reactions_.open(view, before_);
  kick(view, state, planes && resolved_, false, state.v, exchange);
  next_ = state.x + view.h * state.v;
  drift_pins(view, state.v, next_, exchange);
  return planes ? contact_.drift(view, before_, state.v, next_, exchange) : StepStatus::ok;
}

StepStatus DampedLeapfrog::close(const StepView& view, State& state, Exchange& exchange) {
  const bool touched = !view.around.planes.empty() && contact_.touched();
  middle_ = before_ = state.v;
  view.around.visit_pinned(view.t1, [&](const PinnedPoint& held) { set_row(before_, held.point, held.velocity()); });
  prepare_kick(view, state, -view.h);
  if (touched && resolved_) reactions_.close(view, contact_, before_);
  kick(view, state, touched && resolved_, true, state.v, exchange);
  close_pins(view, middle_, state.v, exchange);
  return touched ? contact_.close(view, state.v, exchange) : StepStatus::ok;
}

void DampedLeapfrog::prepare_kick(const StepView& view, const State& state, double drift) {
  inner_ = state.spring;
  view.body.springs.add_dashpot_force(state.x, before_, inner_, drift);
}

void DampedLeapfrog::kick(const StepView& view, const State& state, bool held, bool drifted, Points& v, Exchange& exchange) {
  if (held) acting_ = view.force + reactions_.forces();
  const Points& outside = held ? acting_ : view.force;
  kick_.apply(view.body, state.x, inner_, outside, before_, v);
  if (view.around.watch && !view.around.damping_unwatched)
    exchange.dissipated += kick_.loss(view.body, state.spring, outside, before_, v, drifted);
  if (held) reactions_.give_back(view, v);
}

}  // namespace softffd
