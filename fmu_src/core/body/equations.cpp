#include "body/equations.hpp"

namespace softffd {

void Equations::place_pins(double t, Points& x) const {
  around.visit_pinned(t, [&](const PinnedPoint& held) { set_row(x, held.point, held.place()); });
}

void Equations::place_pins(double t, Points& x, Points& v) const {
  around.visit_pinned(t, [&](const PinnedPoint& held) {
    set_row(x, held.point, held.place());
    set_row(v, held.point, held.velocity());
  });
}

const Points& Equations::outside(double t, Points& scratch) const {
  if (!around.ramped) return around.force;
  around.force_at(t, scratch);
  return scratch;
}

const Points& Equations::inner(const Points& x, const Points& v, const Points& spring, Points& scratch) const {
  if (!body.dashpots()) return spring;
  scratch = spring;
  body.add_dashpot_force(x, v, scratch);
  return scratch;
}

void Equations::acceleration(double t, const Points& x, const Points& v, Points& scratch, Points& inner, Points& a) const {
  body.internal_force(x, inner);
  body.add_dashpot_force(x, v, inner);
  acceleration(t, v, inner, scratch, a);
}

void Equations::acceleration(double t, const Points& v, const Points& inner, Points& scratch, Points& a) const {
  const Points& force = outside(t, scratch);
  const std::size_t n = a.size();
  if (body.damped)
    kernels::accelerate_damped(n, body.inverse_mass.data(), body.damping_rate.data(), inner.data(), force.data(), v.data(), a.data());
  else
    kernels::accelerate(n, body.inverse_mass.data(), inner.data(), force.data(), a.data());
}

void Ledger::open(const Equations& equations, bool watch, bool lossy) {
  watch_ = watch && (equations.around.ramped || equations.body.damped || lossy);
  recording_ = watch_ || !pins_.empty();
  if (!recording_) return;
  for (Impulse& pin : pins_) pin = {};
  dissipated_ = work_ = 0;
}

void Ledger::stage(const Equations& equations, double weight, double t, const Points& x, const Points& inner) {
  const Body& body = equations.body;
  const Drive& around = equations.around;
  around.visit_pinned(t, [&](const PinnedPoint& held) {
    const int p = held.point;
    const Vec3 velocity = held.velocity();
    Vec3 outside = row(around.force, p);
    for (int axis = 0; around.ramped && axis < 3; ++axis) outside[axis] += around.ramp(p + axis * x.rows(), t);
    const Vec3 force = row(inner, p) + outside - body.damping[p] * velocity;
    pins_[held.pin].add(weight * force, held.arm);
    pins_[held.pin].torque -= weight * body.mass[p] * held.frame.velocity.cross(velocity);
    work_ -= weight * force.dot(velocity);
  });
  if (watch_ && around.ramped) work_ -= weight * around.ramp_rate_dot(t, x);
}

void Ledger::damp(const Equations& equations, double weight, const Points& x, const Points& v) {
  if (!watch_ || !equations.body.damped || equations.around.damping_unwatched) return;
  const Body& body = equations.body;
  for (int axis = 0; axis < 3; ++axis) dissipated_ += weight * (body.damping * v.col(axis).square()).sum();
  dissipated_ += weight * body.dashpot_power(x, v);
}

void Ledger::end(const Equations& equations, double sign, double t, const Points& x, const Points& v) {
  const auto& [body, around] = equations;
  for (std::size_t a = 0; a < pins_.size(); ++a) {
    const Frame frame = around.pins[a].at(t);
    for (int p : around.pins[a].points) {
      const Vec3 velocity = row(v, p), momentum = sign * body.mass[p] * velocity;
      pins_[a].add(-momentum, row(x, p) - frame.origin);
      work_ += 0.5 * momentum.dot(velocity);
    }
  }
  if (watch_ && around.ramped) work_ += sign * around.ramp_dot(t, x);
}

void Ledger::ends(const Equations& equations, double t0, const Points& x0, const Points& v0, double t1, const Points& x1,
                  const Points& v1) {
  end(equations, -1, t0, x0, v0);
  end(equations, 1, t1, x1, v1);
}

void Ledger::add_to(Exchange& exchange) const {
  for (std::size_t a = 0; a < pins_.size(); ++a) exchange.pins[a].force += pins_[a].force, exchange.pins[a].torque += pins_[a].torque;
  exchange.dissipated += dissipated_;
  exchange.work += work_;
}

}  // namespace softffd
