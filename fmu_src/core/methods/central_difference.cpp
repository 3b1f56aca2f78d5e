#include "methods/central_difference.hpp"

#include <algorithm>

#include "methods/traits.hpp"

namespace softffd {

namespace {

/// Eq. (11): computes the position one step back that yields the present velocity and acceleration.
void start(const Body& body, const Points& force, double h, State& state) {
  Points& previous = state.previous.change();
  for (int axis = 0; axis < 3; ++axis) {
    const auto v = state.v.col(axis);
    const auto acceleration = (state.spring.col(axis) + force.col(axis) - body.damping * v) / body.mass;
    previous.col(axis) = state.x.col(axis) - h * v + 0.5 * h * h * acceleration;
  }
  state.previous_h = h;
}

/// Applies eq. (14) to (17) to one point and plane at time t. Returns the impulse on the point [N s]; zero without contact.
Vec3 collide(double friction, const HalfSpace& now, double inertia, double h, const Vec3& x, const Vec3& previous, Vec3& next) {
  if (now.gap(x) >= 0) return Vec3::Zero();
  const Vec3& n = now.normal;
  const Vec3 surface = now.material_velocity(x), free = next;
  const double pushed = n.dot(previous - next) + 2 * h * n.dot(surface);  // contact acceleration times h^2
  if (pushed <= 0) return Vec3::Zero();
  const Vec3 travel = next - x - h * surface, slip = travel - n.dot(travel) * n;
  const double size = slip.norm(), limit = friction * pushed;
  next += pushed * n;
  if (size > 0) next -= std::min(1.0, limit / size) * slip;
  return inertia * h * (next - free);
}

}  // namespace

void CentralDifference::step(const Body& body, const Drive& around, double t, double h, const State& state, Exchange* exchange) {
  around.force_at(t, force_);
  for (int axis = 0; axis < 3; ++axis) {
    const auto inertia = body.mass / (h * h), drag = body.damping / (2 * h);
    next_.col(axis) =
        (2 * inertia * state.x.col(axis) - (inertia - drag) * state.previous->col(axis) + state.spring.col(axis) + force_.col(axis)) /
        (inertia + drag);
  }
  for (std::size_t q = 0; q < around.planes.size(); ++q) {
    const HalfSpace now = around.planes[q].at(t);
    for (int p = 0; p < body.points(); ++p) {
      if (body.pinned[p]) continue;
      Vec3 next = row(next_, p);
      const Vec3 x = row(state.x, p), previous = row(*state.previous, p), free = next;
      const double inertia = body.mass[p] / (h * h) + body.damping[p] / (2 * h);
      const Vec3 impulse = collide(around.planes[q].friction, now, inertia, h, x, previous, next);
      if (impulse.isZero(0)) continue;
      set_row(next_, p, next);
      if (!exchange) continue;
      const Vec3 surface = now.material_velocity(x), mean = (0.5 * (free + next) - previous) / (2 * h);
      exchange->push(exchange->planes[q], impulse, x - now.point, surface);
      exchange->touch(q, p, impulse);
      exchange->dissipated -= impulse.dot(mean - surface);
      ++exchange->contacts_resolved;
    }
  }
  around.visit_pinned(t + h, [&](const PinnedPoint& held) {
    const int p = held.point;
    const double inertia = body.mass[p] / (h * h) + body.damping[p] / (2 * h);
    const Vec3 here = held.place(), impulse = inertia * h * (here - row(next_, p));
    set_row(next_, p, here);
    if (exchange) exchange->push(exchange->pins[held.pin], impulse, held.arm, held.velocity());
  });
  if (around.watch && exchange && body.damped && !around.damping_unwatched) {
    double power = 0;
    for (int axis = 0; axis < 3; ++axis) power += (body.damping * ((next_.col(axis) - state.previous->col(axis)) / (2 * h)).square()).sum();
    exchange->dissipated += h * power;
  }
}

Outcome CentralDifference::advance(const Model& model, const Drive& drive, const Span& span, Run& run) {
  State& state = run.physical.motion;
  if (state.previous_h != span.h) {
    drive.force_at(span.time(0), force_);
    start(model.body, force_, span.h, state);
  }
  for (Count i = 0; i < span.steps; ++i) {
    step(model.body, drive, span.time(i), span.h, state, &run.physical.exchange);
    if (drive.watch && drive.ramped) run.physical.exchange.work += drive.ramp_dot(span.time(i) + 0.5 * span.h, next_ - state.x);
    state.previous.change().swap(state.x);
    state.x.swap(next_);
    model.body.internal_force(state.x, state.spring);
  }
  step(model.body, drive, span.time(span.steps), span.h, state, nullptr);
  state.v = (next_ - *state.previous) / (2 * span.h);
  return {.work = double(span.steps) * traits(Method::central_difference).work};
}

}  // namespace softffd
