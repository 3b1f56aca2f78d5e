#include "leapfrog.hpp"

namespace softffd {

namespace {

/// Books the momentum that a half kick and the forces acting in it do not explain on the pin that held the point.
void book(const Body& body, Impulse& pin, Exchange& exchange, int p, const Vec3& change, const Vec3& force, const Vec3& damped_velocity,
          double half, const Vec3& arm, const Vec3& mean_velocity) {
  const Vec3 impulse = body.mass[p] * change - half * (force - body.damping[p] * damped_velocity);
  pin.add(-impulse, arm);
  exchange.work += impulse.dot(mean_velocity);
}

/// Pinned points at time t1: the drift takes them where the frame is.
void drift_pins(const Body& body, const Surroundings& around, double t1, double h, const State& state, const Points& before, Points& v,
                Points& x1, Exchange& exchange) {
  for (std::size_t a = 0; a < around.pins.size(); ++a) {
    const Pin& pin = around.pins[a];
    for (std::size_t n = 0; n < pin.points.size(); ++n) {
      const int p = pin.points[n];
      const Vec3 arm = pin.arm(int(n), t1), here = pin.origin(t1) + arm;
      const Vec3 old = row(before, p), velocity = (here - row(state.x, p)) / h;
      const Vec3 force = row(state.spring, p) + row(around.force, p);
      book(body, exchange.pins[a], exchange, p, velocity - old, force, old, 0.5 * h, arm, 0.5 * (old + velocity));
      set_row(x1, p, here);
      set_row(v, p, velocity);
    }
  }
}

/// Pinned points after the closing half kick: they have the frame's velocity.
void close_pins(const Body& body, const Surroundings& around, double t1, double h, const Points& before, State& state, Exchange& exchange) {
  for (std::size_t a = 0; a < around.pins.size(); ++a) {
    const Pin& pin = around.pins[a];
    for (std::size_t n = 0; n < pin.points.size(); ++n) {
      const int p = pin.points[n];
      const Vec3 arm = pin.arm(int(n), t1), velocity = pin.material_velocity(arm);
      const Vec3 old = row(before, p), force = row(state.spring, p) + row(around.force, p);
      book(body, exchange.pins[a], exchange, p, velocity - old, force, velocity, 0.5 * h, arm, 0.5 * (old + velocity));
      set_row(state.v, p, velocity);
    }
  }
}

double damping_power(const Body& body, const Points& v) { return (body.damping * v.square().rowwise().sum()).sum(); }

}  // namespace

Leapfrog::Leapfrog(int points, int planes) : kicks_(points), contact_(points, planes), before_(points, 3), next_(points, 3) {}

StepStatus Leapfrog::advance(const Body& body, const Surroundings& around, const Task& task, bool watch, State& state, Exchange& exchange) {
  const bool planes = !around.planes.empty(), pins = !around.pins.empty();
  const std::size_t n = state.x.size();
  kicks_.prepare(body, task.h);
  for (long i = 0; i < task.steps; ++i) {
    const double t1 = task.time(i + 1);
    const StepView step{body, kicks_, around, state.spring, state.x, task.time(i), t1, task.h};
    if (planes || pins) before_ = state.v;
    if (watch && body.damped) exchange.dissipated += 0.5 * task.h * damping_power(body, state.v);
    kicks_.open(state.spring, around.force, state.v);
    kernels::drift(n, task.h, state.x.data(), state.v.data(), next_.data());
    if (pins) drift_pins(body, around, t1, task.h, state, before_, state.v, next_, exchange);
    if (planes) {
      const StepStatus status = contact_.drift(step, before_, state.v, next_, exchange);
      if (status != StepStatus::ok) return status;
    }
    state.x.swap(next_);
    body.springs.force(state.x, state.spring);
    const bool touched = planes && contact_.touched();
    if (touched || pins) before_ = state.v;
    kicks_.close(state.spring, around.force, state.v);
    if (pins) close_pins(body, around, t1, task.h, before_, state, exchange);
    if (touched) {
      const StepStatus status = contact_.close(step, before_, state.x, state.v, exchange);
      if (status != StepStatus::ok) return status;
    }
    if (watch && body.damped) exchange.dissipated += 0.5 * task.h * damping_power(body, state.v);
  }
  return StepStatus::ok;
}

}  // namespace softffd
