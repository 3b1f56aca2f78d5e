#include "methods/leapfrog.hpp"

#include <algorithm>

#include "contact/free/free_parts.hpp"
#include "methods/traits.hpp"

namespace softffd {

namespace {

/// Returns the impulse of the forces on a point in half a step, with damping at velocity v [N s].
Vec3 kick_of(const StepView& step, int p, const Vec3& v) {
  return 0.5 * step.h * (row(step.spring, p) + row(step.force, p) - step.body.damping[p] * v);
}

/// Returns the impulse that takes a pinned point from one velocity to the other in addition to the forces in half a step, with their
/// damping at velocity `damped` [N s].
Vec3 beyond_kick(const StepView& step, int p, const Vec3& from, const Vec3& to, const Vec3& damped) {
  return step.body.mass[p] * (to - from) - kick_of(step, p, damped);
}

/// Returns the energy that weak point damping takes in a step from velocities v0 to v1 [J]. The impulse of damping on a point is
/// -(d h/2) (v0 + v1), through contact too, so that its work is exactly -d h |(v0 + v1) / 2|^2.
double weak_loss(const HalfKicks& kicks, double h, const Points& v0, const Points& v1) {
  double loss = 0;
  for (int axis = 0; axis < 3; ++axis) loss += (kicks.weak_damping() * (0.5 * (v0.col(axis) + v1.col(axis))).square()).sum();
  return h * loss;
}

/// Returns the energy that strong point damping takes in the half kicks from v0 to v and from v to v1 [J]: the impulse of each that is not
/// of the force f = d (v - E v0) / (1 - E), at the mean velocity.
double strong_loss(const HalfKicks& kicks, const Body& body, double h, const Points& v0, const Points& v, const Points& v1) {
  double loss = 0;
  if (!kicks.any_strong()) return loss;
  for (int p = 0; p < body.points(); ++p) {
    if (kicks.weak_damping()[p] == body.damping[p]) continue;
    const double g = 0.5 * body.damping[p] * h / body.mass[p], kept = 1 / (1 + g + 0.5 * g * g);
    const auto taken = [&](const Vec3& from, const Vec3& to) {
      return 0.5 * body.mass[p] * (g / (1 - kept) * (to - kept * from) - (to - from)).dot(from + to);
    };
    loss += taken(row(v0, p), row(v, p)) + taken(row(v, p), row(v1, p));
  }
  return loss;
}

/// True if the energy that damping takes is to be booked.
bool losses(const Body& body, const Drive& around) { return around.watch && body.damped && !around.damping_unwatched; }

/// Number of steps for which the state between kicks is kept for a block that has touched a plane: recomputing it costs as much as some
/// ten of these steps.
constexpr Count keep_for = 100;

/// True if the work of ramped forces or of damping in a step is to be booked.
bool booked(const Body& body, const Drive& around) { return around.watch && (around.ramped || losses(body, around)); }

}  // namespace

Leapfrog::Leapfrog(int points, int planes)
    : kicks_(points),
      contact_(points, planes),
      before_(points, 3),
      start_(points, 3),
      next_(points, 3),
      force_(points, 3),
      closed_(points, 3),
      keep_until_((points + FusedPass::lanes - 1) / FusedPass::lanes, -1) {}

Outcome Leapfrog::advance(const Model& model, const Drive& drive, const Span& span, Run& run) {
  const bool dashpots = model.body.dashpots();
  if (dashpots && !carries_velocities(drive, run, span.h)) {
    if (!damped_) damped_ = std::make_unique<DampedLeapfrog>(model.body.points(), int(drive.planes.size()));
    return damped_->advance(model, drive, span, run);
  }
  if (model.body.samples && !drive.planes.empty() && !surface_)
    surface_ = std::make_unique<SurfaceContact>(model.body, int(drive.planes.size()));
  const auto impacts = [&] { return surface_ ? surface_->impacts() : contact_.impacts(); };
  const Count before = impacts();
  if (dashpots && carried_.size() == 0) carried_ = forces_ = Points(before_.rows(), 3);
  kicks_.prepare(model.body, span.h);
  if (drive.ramped) drive.force_at(span.time(0), force_);
  const bool free = drive.planes.empty() && drive.pins.empty() && model.body.fused() && !dashpots;
  Outcome outcome{.work = double(span.steps) * step_work(model.body, drive, run, Method::leapfrog, span.h)};
  if (free && !booked(model.body, drive)) {
    glide(model.body, drive, span, run.physical.motion);
    return outcome;
  }
  if (surface_) {
    surface_->begin(model.body, kicks_, drive, span.time(0), span.h);
    surface_->allow(span.budget - outcome.work);
  } else {
    contact_.begin(drive, span.time(0), span.h);
  }
  outcome.status = run_steps(model.body, drive, span, run.physical);
  if (surface_) outcome.spent = outcome.work + surface_->work();
  outcome.impacts = impacts() - before;
  return outcome;
}

/// Takes steps for which nothing is needed between forces and the next drift: each step but the first and last is one fused pass.
void Leapfrog::glide(const Body& body, const Drive& around, const Span& span, State& state) {
  const Points& force = around.ramped ? force_ : around.force;
  const Stage stage = kicks_.stage(around.even);
  before_.swap(state.v);
  kicks_.open(state.spring, force, before_, state.x, state.v, next_);
  state.x.swap(next_);
  for (Count i = 1; i < span.steps; ++i) {
    if (around.ramped) around.force_at(span.time(i), force_);
    body.fused()->advance(stage, force, state.x, state.v, next_);
    state.x.swap(next_);
  }
  body.internal_force(state.x, state.spring);
  if (around.ramped) around.force_at(span.time(span.steps), force_);
  kicks_.close(state.spring, force, state.v);
}

StepStatus Leapfrog::run_steps(const Body& body, const Drive& around, const Span& span, PhysicalState& physical) {
  State& state = physical.motion;
  const bool dashpots = body.dashpots(), at_once = around.pins.empty() && body.fused() && !booked(body, around) && !dashpots;
  const Points& force = around.ramped ? force_ : around.force;
  if (dashpots) take_dashpots(body, state, state.v);
  const auto view = [&](Count i) {
    return StepView{body, kicks_, around, dashpots ? forces_ : state.spring, force, state.x, span.time(i), span.time(i + 1), span.h};
  };
  StepStatus status = open(view(0), physical);
  for (Count i = 1; i < span.steps && status == StepStatus::ok; ++i) {
    if (at_once) {
      status = close_and_open(view(i - 1), view(i), physical);
      continue;
    }
    status = close(view(i - 1), physical);
    if (status == StepStatus::ok) status = open(view(i), physical);
  }
  return status == StepStatus::ok ? close(view(span.steps - 1), physical) : status;
}

/// Takes a step up to the end of its drift.
StepStatus Leapfrog::open(const StepView& view, PhysicalState& physical) {
  State& state = physical.motion;
  Exchange& exchange = physical.exchange;
  const Drive& around = view.around;
  if (losses(view.body, view.around)) start_ = state.v;
  before_.swap(state.v);
  kicks_.open(view.spring, view.force, before_, state.x, state.v, next_);
  if (!around.free.empty()) kick_parts(view, state.free, [&](int p) { return kick_of(view, p, row(before_, p)); });
  if (!around.pins.empty()) {
    const auto impulse = [&](int p, const Vec3& v) { return beyond_kick(view, p, row(before_, p), v, row(before_, p)); };
    drift_pins(view, before_, impulse, state.v, next_, pins_, exchange);
  }
  if (!around.planes.empty()) {
    if (surface_ && surface_->spent()) return StepStatus::not_finite;
    find(view, physical);
    if (const StepStatus status = position_stage(view, physical); status != StepStatus::ok) return status;
  }
  if (!surface_) fly(view, state.free);
  if (around.watch && around.ramped) exchange.work += around.ramp_dot(0.5 * (view.t0 + view.t1), next_ - state.x);
  if (losses(view.body, view.around)) exchange.dissipated += dashpot_loss(view, state, before_);
  state.x.swap(next_);
  return StepStatus::ok;
}

/// Takes a step from the end of its drift to the end of the step.
StepStatus Leapfrog::close(const StepView& view, PhysicalState& physical) {
  State& state = physical.motion;
  Exchange& exchange = physical.exchange;
  const Drive& around = view.around;
  renew_forces(view, state);
  if (around.ramped) around.force_at(view.t1, force_);
  if (!around.pins.empty() || losses(view.body, around)) before_ = state.v;
  kicks_.close(view.spring, view.force, state.v);
  if (losses(view.body, around)) exchange.dissipated += strong_loss(kicks_, view.body, view.h, start_, before_, state.v);
  if (!around.free.empty()) kick_parts(view, state.free, [&](int p) { return kick_of(view, p, row(before_, p)); });
  if (!around.pins.empty()) {
    const auto impulse = [&](int p, const Vec3& v) { return beyond_kick(view, p, row(before_, p), v, v); };
    close_pins(view, before_, impulse, state.v, pins_, exchange);
  }
  if (!around.planes.empty()) {
    const StepStatus status =
        surface_ ? surface_->close(view, state.v, physical.surface, state.free, exchange) : contact_.close(view, state.v, exchange);
    if (status != StepStatus::ok) return status;
    if (surface_ && SurfaceContact::wants_loss(view)) exchange.dissipated += surface_->loss(view, state.v);
  }
  pins_.book(around, state.v, exchange);
  if (losses(view.body, view.around))
    exchange.dissipated += weak_loss(kicks_, view.h, start_, state.v) + dashpot_loss(view, state, before_);
  return StepStatus::ok;
}

/// Computes the forces after the drift, with dashpots at velocities that are carried on to the end of the step.
void Leapfrog::renew_forces(const StepView& view, State& state) {
  const Body& body = view.body;
  if (!body.dashpots()) return body.internal_force(state.x, state.spring);
  const auto push = [&](double time) {
    kernels::push(carried_.size(), time, body.inverse_mass.data(), state.spring.data(), carried_.data());
  };
  carried_ = 2 * state.v - before_;
  push(-0.5 * view.h);
  body.internal_force(state.x, state.spring);
  push(0.5 * view.h);
  view.around.visit_pinned(view.t1, [&](const PinnedPoint& held) { set_row(carried_, held.point, held.velocity()); });
  take_dashpots(body, state, carried_);
}

/// Sets forces_ to the forces of springs and dashpots, the latter at velocities v.
void Leapfrog::take_dashpots(const Body& body, const State& state, const Points& v) {
  forces_ = state.spring;
  body.add_dashpot_force(state.x, v, forces_);
}

/// Returns the energy that the dashpots take in half a step from velocities v0 to the velocities of the state [J].
double Leapfrog::dashpot_loss(const StepView& view, const State& state, const Points& v0) const {
  return view.body.dashpots() ? -0.25 * view.h * ((forces_ - state.spring) * (v0 + state.v)).sum() : 0;
}

/// Looks for contact after the free drift.
void Leapfrog::find(const StepView& view, const PhysicalState& physical) {
  if (surface_)
    surface_->find(view, next_, physical.surface);
  else
    contact_.find(view, next_);
}

template <class See>
void Leapfrog::each_found(const See& see) {
  if (surface_ && surface_->near()) std::for_each(keep_until_.begin(), keep_until_.end(), see);
  if (surface_ || !contact_.touched()) return;
  for (auto at = contact_.behind().begin(); at != contact_.behind().end();)
    for (Count& until : keep_until_)
      if (*at++) see(until);
}

/// True if the points found are those of the step before, and the state between kicks is kept for their blocks for `steps` more steps.
bool Leapfrog::lasts(Count steps) const { return !surface_ && contact_.same() && any_until_ >= step_ + steps; }

StepStatus Leapfrog::position_stage(const StepView& view, PhysicalState& physical) {
  ++step_;
  if (!lasts(keep_for / 2)) each_found([&](Count& until) { until = any_until_ = step_ + keep_for; });
  return surface_ ? surface_->drift(view, before_, physical.motion.v, next_, physical.surface, physical.motion.free, physical.exchange)
                  : contact_.drift(view, before_, physical.motion.v, next_, physical.exchange);
}

/// Takes the end of a step and the next step up to the end of its drift in one pass over all points, then corrects the points that touch a
/// plane. The correction needs the state between the two kicks, which is kept for blocks of points that have touched a plane of late.
StepStatus Leapfrog::close_and_open(const StepView& last, const StepView& next, PhysicalState& physical) {
  State& state = physical.motion;
  if (surface_ && surface_->touched()) {  // the closing stage moves all points
    const StepStatus status = close(last, physical);
    return status == StepStatus::ok ? open(next, physical) : status;
  }
  if (last.around.ramped) last.around.force_at(last.t1, force_);
  before_.swap(state.v);
  last.body.fused()->advance(kicks_.stage(last.around.even), last.force, state.x, before_, state.v, next_,
                             {any_until_ < step_ ? nullptr : keep_until_.data(), step_, state.spring.data()});
  StepStatus status = surface_ ? StepStatus::ok : contact_.close_and_go_on(last, before_, next_, physical.exchange);
  if (status != StepStatus::ok) return status;
  find(next, physical);
  bool kept = true;
  if (!lasts(0)) each_found([&](Count until) { kept = kept && until >= step_; });
  if (!kept) recall(last, state);
  status = position_stage(next, physical);
  state.x.swap(next_);
  return status;
}

/// Recomputes the state between the two kicks for blocks for which it was not kept.
void Leapfrog::recall(const StepView& last, State& state) {
  last.body.internal_force(state.x, state.spring);
  closed_ = before_;
  kicks_.close(state.spring, last.force, closed_);
  for (int p = 0; p < closed_.rows(); ++p)
    if (keep_until_[p / FusedPass::lanes] < step_) set_row(before_, p, row(closed_, p));
}

}  // namespace softffd
