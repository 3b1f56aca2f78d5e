#include "methods/damped_leapfrog.hpp"

#include "contact/free/free_parts.hpp"
#include "methods/traits.hpp"

namespace softffd {

namespace {

/// Largest product of half-kick length and fastest damping rate for which one explicit step of the half kick is stable [1].
constexpr double explicit_kick = 2;

/// Returns a function of point p: the impulse that a kick from velocities v0 to v gave this pinned point [N s].
auto kicked_by(const StepView& step, const Points& v0, const Points& v) {
  return [&](int p) { return Vec3(step.body.mass[p] * (row(v, p) - row(v0, p))); };
}

bool losses(const Drive& around) { return around.watch && !around.damping_unwatched; }

/// Returns the kinetic energy that the points that are not pinned lose from velocities v0 to v1 [J].
double slowed(const Body& body, const Points& v0, const Points& v1) {
  double energy = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (int p = 0; p < body.points(); ++p)
      if (!body.pinned[p]) energy += 0.5 * body.mass[p] * (v0(p, axis) - v1(p, axis)) * (v0(p, axis) + v1(p, axis));
  return energy;
}

/// Returns how much more work the forces on these points do in half a step if the points move with v1 instead of v0 [J].
double more_work(const StepView& step, const Points& spring, const Points& v0, const Points& v1) {
  double work = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (int p = 0; p < step.body.points(); ++p)
      if (!step.body.pinned[p]) work += (v1(p, axis) - v0(p, axis)) * (spring(p, axis) + step.force(p, axis));
  return 0.5 * step.h * work;
}

}  // namespace

DampedLeapfrog::DampedLeapfrog(int points, int planes)
    : masses_(points), kick_(points), contact_(points, planes), reactions_(points, planes) {
  for (Points* each : {&before_, &middle_, &next_, &force_, &inner_, &acting_, &kicked_, &rates_, &drift_}) each->setZero(points, 3);
}

double DampedLeapfrog::longest_with_reactions(const Body& body) { return 2 * explicit_kick / body.fastest_damping; }

Outcome DampedLeapfrog::advance(const Model& model, const Drive& drive, const Span& span, Run& run) {
  if (model.body.samples && !drive.planes.empty() && !surface_)
    surface_ = std::make_unique<SurfaceContact>(model.body, int(drive.planes.size()));
  const Count before = impacts();
  masses_.take_masses(model.body);
  const double rate = run.control.damping_bound;
  kick_.prepare(model.body, 0.5 * span.h, rate < 0 ? model.body.fastest_damping : rate);
  Outcome outcome{.work = double(span.steps) * (traits(Method::leapfrog).work + 2 * kick_.products())};
  if (surface_) {
    surface_->begin(model.body, masses_, drive, span.time(0), span.h);
    surface_->allow(span.budget - outcome.work);
    surface_->look(drive, span.time(0), run.physical.motion.x);
  } else {
    contact_.begin(drive, span.time(0), span.h);
  }
  resolved_ = span.h <= (1 + 1e-9) * longest_with_reactions(model.body);
  for (Count i = 0; i < span.steps && outcome.status == StepStatus::ok; ++i)
    outcome.status = step(model.body, drive, span, i, run.physical);
  outcome.impacts = impacts() - before;
  if (surface_) outcome.spent = outcome.work + surface_->work();
  return outcome;
}

StepStatus DampedLeapfrog::step(const Body& body, const Drive& around, const Span& span, Count i, PhysicalState& physical) {
  State& state = physical.motion;
  const double t0 = span.time(i), t1 = span.time(i + 1);
  const StepView view{body, masses_, around, inner_, around.ramped ? force_ : around.force, state.x, t0, t1, span.h};
  if (around.ramped) around.force_at(t0, force_);
  const StepStatus status = open(view, physical);
  if (status != StepStatus::ok) return status;
  if (around.watch && around.ramped) physical.exchange.work += around.ramp_dot(0.5 * (t0 + t1), next_ - state.x);
  state.x.swap(next_);
  body.internal_force(state.x, state.spring);
  if (around.ramped) around.force_at(t1, force_);
  return close(view, physical);
}

StepStatus DampedLeapfrog::open(const StepView& view, PhysicalState& physical) {
  State& state = physical.motion;
  Exchange& exchange = physical.exchange;
  const bool planes = !view.around.planes.empty();
  before_.swap(state.v);
  prepare_kick(view, state, before_, view.h);
  const bool held = planes && is_held(physical);
  if (held) {
    if (surface_)
      reactions_.hold(view, *surface_, physical, before_);
    else
      reactions_.open(view, before_);
  }
  kick(view, state, held, false, exchange);
  kernels::drift(next_.size(), view.h, state.x.data(), state.v.data(), next_.data());
  kick_parts(view, state.free, kicked_by(view, before_, state.v));
  const auto impulse = [&](int p, const Vec3& v) { return Vec3(view.body.mass[p] * (v - row(state.v, p))); };
  drift_pins(view, before_, impulse, state.v, next_, pins_, exchange);
  if (!planes) {
    fly(view, state.free);
    return StepStatus::ok;
  }
  const double work = exchange.work, dissipated = exchange.dissipated;
  const Count before = impacts();
  if (surface_ && surface_->spent()) return StepStatus::not_finite;
  if (surface_)
    surface_->find(view, next_, physical.surface);
  else
    contact_.find(view, next_);
  const StepStatus status = surface_ ? surface_->drift(view, before_, state.v, next_, physical.surface, state.free, exchange)
                                     : contact_.drift(view, before_, state.v, next_, exchange);
  if (!surface_) fly(view, state.free);
  lands_ = impacts() > before;
  if (lands_) drift_ = next_ - state.x;
  if (!losses(view.around)) return status;
  exchange.dissipated = dissipated + (exchange.work - work) + slowed(view.body, kicked_, state.v);
  exchange.dissipated += more_work(view, state.spring, kicked_, state.v);
  return status;
}

/// If a point lands, the dashpots feel the landing from then on. Their velocities are therefore chosen so that the mean of these and the
/// velocities after the opening kick is the mean velocity of the drift.
StepStatus DampedLeapfrog::close(const StepView& view, PhysicalState& physical) {
  State& state = physical.motion;
  Exchange& exchange = physical.exchange;
  const bool touched = !view.around.planes.empty() && (surface_ ? surface_->touched() : contact_.touched());
  before_.swap(state.v);
  if (!view.around.pins.empty()) middle_ = before_;
  view.around.visit_pinned(view.t1, [&](const PinnedPoint& held) { set_row(before_, held.point, held.velocity()); });
  const bool landed = lands_ && resolved_;
  if (landed) {
    rates_ = before_;
    for (int p = 0; p < view.body.points(); ++p)
      if (!view.body.pinned[p]) set_row(rates_, p, 2 / view.h * row(drift_, p) - row(kicked_, p));
  }
  prepare_kick(view, state, landed ? rates_ : before_, -view.h);
  const bool held = touched && is_held(physical);
  if (held) {
    if (surface_)
      reactions_.hold(view, *surface_, physical, before_);
    else
      reactions_.close(view, contact_, before_);
  }
  kick(view, state, held, true, exchange);
  kick_parts(view, state.free, kicked_by(view, before_, state.v));
  const auto impulse = [&](int p, const Vec3& v) {  // the kick began with the velocity of the frame
    return Vec3(view.body.mass[p] * ((row(before_, p) - row(middle_, p)) + (v - row(state.v, p))));
  };
  close_pins(view, middle_, impulse, state.v, pins_, exchange);
  StepStatus status = StepStatus::ok;
  if (touched) {
    const double work = exchange.work, dissipated = exchange.dissipated;
    status = surface_ ? surface_->close(view, state.v, physical.surface, state.free, exchange) : contact_.close(view, state.v, exchange);
    if (losses(view.around)) exchange.dissipated = dissipated + (exchange.work - work) + slowed(view.body, kicked_, state.v);
    if (surface_ && losses(view.around)) exchange.dissipated += surface_->loss_of_free_pins(view, state.v);
  }
  pins_.book(view.around, state.v, exchange);
  return status;
}

void DampedLeapfrog::prepare_kick(const StepView& view, const State& state, const Points& rates, double drift) {
  inner_ = state.spring;
  view.body.add_dashpot_force(state.x, rates, inner_, drift);
}

/// True if something may rest on an obstacle, held by forces that the kick has to contain.
bool DampedLeapfrog::is_held(const PhysicalState& physical) const { return resolved_ && (!surface_ || surface_->lasts(physical.surface)); }

/// Applies a half kick from before_; `held`: with the reactions of obstacles. The loss of the kick does not contain the work of the
/// reactions, which is booked with the contact.
void DampedLeapfrog::kick(const StepView& view, State& state, bool held, bool drifted, Exchange& exchange) {
  if (held) acting_ = view.force + reactions_.forces();
  kick_.apply(view.body, state.x, inner_, held ? acting_ : view.force, before_, state.v);
  if (!view.around.planes.empty() && (!drifted || losses(view.around))) kicked_ = state.v;
  if (losses(view.around)) exchange.dissipated += kick_.loss(view.body, state.spring, view.force, before_, state.v, drifted);
  if (held) reactions_.give_back(view, state.v);
}

}  // namespace softffd
