#include "contact/implicit/implicit_contact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/implicit/carried.hpp"
#include "machine/elementary.hpp"
namespace softffd {

namespace {

/// Largest number of successive halvings of a step. A body that buckles jumps to its next equilibrium as fast as its own vibrations are,
/// and for a moment steps have to be that short.
constexpr int most_halvings = 20;
/// Backward Euler gains energy only where a body falls off an edge on which it balances, and then the gain is of second order in the step.
/// A solution that gains more than this fraction of the exchanged energies lies on another branch, with inverted cells for example.
constexpr double most_gain = 0.02;

/// Parameter of SDIRK2: 1 - 1 / sqrt(2).
constexpr double gamma = 0.29289321881345247560;
/// Allowed residual in the stages of SDIRK2, as a fraction of the largest force [1].
constexpr double accuracy = 1e-6;
/// Weights of the velocities at t, t + gamma h and t + h. The step plus h times the weighted sum is of third order for a smooth motion.
constexpr double at_end = 0.19526214587563495, at_stage = -at_end / gamma, at_begin = -at_end - at_stage;

}  // namespace

ImplicitContact::ImplicitContact(const Lattice& lattice, int planes, int pins, const Samples* samples)
    : stage_(lattice, planes, samples), first_v_(Points::Zero(lattice.points(), 3)) {
  before_.planes.resize(planes);
  before_.pins.resize(pins);
  for (Points* each : {&start_.x, &start_.v, &start_.spring}) *each = first_v_;
  start_.holds.assign(planes, first_v_);
}

void ImplicitContact::begin_call() {
  stage_.limit(factorizations() + most_factorizations, solutions() + double(most_solutions), most_operations);
  given_ = 0;
  slip_ = {};
}

StepStatus ImplicitContact::advance(const Equations& equations, double t, double h, bool watch, State& state, Exchange& exchange) {
  begin_call();
  return advance_in_parts(equations, t, h, watch, state, exchange, 0);
}

StepStatus ImplicitContact::advance_in_parts(const Equations& equations, double t, double h, bool watch, State& state, Exchange& exchange,
                                             int depth) {
  const StepStatus status = take_euler({equations, t, h, state, t + 0.5 * h, kept_}, watch, state, exchange, false);
  if (status != StepStatus::not_finite) return status;
  if (depth == most_halvings || stage_.spent()) return StepStatus::not_finite;
  ++halvings_;
  const StepStatus first = advance_in_parts(equations, t, 0.5 * h, watch, state, exchange, depth + 1);
  if (first != StepStatus::ok) return first;
  return advance_in_parts(equations, t + 0.5 * h, 0.5 * h, watch, state, exchange, depth + 1);
}

/// count: `lost_` becomes the energy that is lost beyond dampers and friction.
StepStatus ImplicitContact::take_euler(const Step& step, bool watch, State& state, Exchange& exchange, bool count) {
  ++steps_;
  open(step);
  if (const StepStatus status = stage_.solve(step); status != StepStatus::ok) return status;
  add_torques(step.h);
  const double outside = (stage_.force() * (stage_.x - state.x)).sum(), work = stage_.contact_work(step);
  const Drive& around = step.equations.around;
  const double ramp = around.ramped ? around.ramp_dot(step.loads_at, stage_.x - state.x) : 0;
  free_work_ = stage_.work_of_free(step);
  if (!close(step, outside, work, watch, ramp, exchange)) return StepStatus::not_finite;
  stage_.book(step, 1, exchange);
  given_ += stage_.given_by_contacts(step, work) - free_work_;
  slip_.add(stage_.slip_of_contacts(step));
  if (count) lost_ -= step.h * stage_.lost_power(step);
  turn_back(watch, exchange);
  take(state);
  return StepStatus::ok;
}

StepStatus ImplicitContact::advance_sdirk2(const Equations& equations, double t, double h, const Span& span, bool watch, State& state,
                                           Exchange& exchange) {
  begin_call();
  before_ = exchange;
  const StepStatus status = take_sdirk2(equations, t, h, span, watch, state, exchange);
  if (status != StepStatus::not_finite || span.way > 0) return status;
  exchange = before_;
  return advance_in_parts(equations, t, h, watch, state, exchange, 0);
}

StepStatus ImplicitContact::take_sdirk2(const Equations& equations, double t, double h, const Span& span, bool watch, State& state,
                                        Exchange& exchange) {
  ++steps_;
  const double part = gamma * h, rest = (1 - gamma) * h, weight = (1 - gamma) / gamma;
  const double way = span.way;
  Carried carried(equations.around, t, state.x, stage_.samples(), equations.body.length);
  start_ = state;
  const Points* ahead = &state.v;
  if (carried.bends()) {
    carried.rates(t, state.x, state.v);
    ahead = &carried.open(t + part, 0, part, start_.x);
  }
  const Step first{equations, t, part, start_, t + part, kept_, ahead, span.again, way, accuracy, carried.bends(), 1};
  open(first);
  if (const StepStatus status = stage_.solve(first); status != StepStatus::ok) return status;
  if (stage_.strikes({equations, t, part, state, t + part, nullptr, nullptr, false, way}))
    return strike(equations, t, h, watch, state, exchange);
  add_torques(rest);
  const auto work_of_loads = [&](const auto& v) { return (stage_.force() * v).sum(); };
  const auto work_of_ramps = [&](double time, const Points& v) { return equations.around.ramped ? equations.around.ramp_dot(time, v) : 0; };
  double outside = rest * work_of_loads(stage_.v), ramp = rest * work_of_ramps(t + part, stage_.v);
  double work = weight * stage_.contact_work(first), known = rest * stage_.lost_power(first);
  const double first_free = weight * stage_.work_of_free(first);
  stage_.book(first, weight, exchange);
  first_v_ = stage_.v;
  first_free_ = stage_.free;
  start_.x = state.x + rest * first_v_;
  ahead = &first_v_;
  if (carried.bends()) {
    carried.rates(t + part, stage_.x, first_v_);
    ahead = &carried.open(t + h, rest, part, start_.x);
  }
  start_.v = state.v + weight * (first_v_ - state.v);
  start_.spring = stage_.spring;
  for (const FreeMotion& each : equations.around.free) {
    const FreeState &from = state.free[each.index()], &by = stage_.free[each.index()];
    FreeState& start = start_.free[each.index()] = each.moved(from, by, rest);
    start.velocity = from.velocity + weight * (by.velocity - from.velocity);
    start.momentum = from.momentum + weight * (by.momentum - from.momentum);
  }
  stage_.touches().hold(start_);
  const Step second{equations, t + rest, part, start_, t + h, kept_, ahead, true, way, accuracy, carried.bends(), 1};
  if (const StepStatus status = stage_.solve(second); status != StepStatus::ok) return status;
  const Step whole{equations, t, h, state, t + h, nullptr, nullptr, false, way, accuracy, false, 1};
  if (stage_.strikes(whole)) {
    exchange = before_;
    return strike(equations, t, h, watch, state, exchange);
  }
  add_torques(part);
  outside += part * work_of_loads(stage_.v);
  ramp += part * work_of_ramps(t + h, stage_.v);
  work += stage_.contact_work(second);
  free_work_ = first_free + stage_.work_of_free(second);
  known += part * stage_.lost_power(second);
  if (!close(whole, outside, work, watch, ramp, exchange)) return StepStatus::not_finite;
  lost_ -= known;
  stage_.book(second, 1, exchange);
  slip_.add(stage_.slip_of_contacts(whole));
  bend_ = 0;
  for (int p = 0; p < equations.body.points(); ++p)
    for (int axis = 0; axis < 3 && !equations.body.pinned[p]; ++axis)
      bend_ = std::max(bend_, std::abs(h * (at_begin * state.v(p, axis) + at_stage * first_v_(p, axis) + at_end * stage_.v(p, axis))));
  for (std::size_t k = 0; k < first_free_.size(); ++k) {
    const Vec3 bend = at_begin * state.free[k].velocity + at_stage * first_free_[k].velocity + at_end * stage_.free[k].velocity;
    bend_ = std::max(bend_, h * bend.cwiseAbs().maxCoeff());
  }
  turn_back(watch, exchange);
  take(state);
  return StepStatus::ok;
}

/// Takes a step of backward Euler: the second stage would throw back what the first one stops, or what lies behind an obstacle between.
StepStatus ImplicitContact::strike(const Equations& equations, double t, double h, bool watch, State& state, Exchange& exchange) {
  const StepStatus status = take_euler({equations, t, h, state, t + 0.5 * h, kept_}, watch, state, exchange, true);
  bend_ = std::numeric_limits<double>::infinity();
  return status;
}

/// Balances the energies of the step [J]. outside: work of all outside forces; ramp_work: the part of it by ramps; work: that of planes
/// and pins. Returns whether the solution is credible.
bool ImplicitContact::close(const Step& step, double outside, double work, bool watch, double ramp_work, Exchange& exchange) {
  const Body& body = step.equations.body;
  double before = 0, gain = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (int p = 0; p < body.points(); ++p) {
      const double v0 = step.from.v(p, axis), v1 = stage_.v(p, axis);
      before += 0.5 * body.mass[p] * v0 * v0;
      gain += 0.5 * body.mass[p] * (v1 - v0) * (v1 + v0);
    }
  const double elastic0 = body.elastic_energy(step.from.x), elastic1 = body.elastic_energy(stage_.x);
  const double loss = outside + work + (elastic0 - elastic1) - gain;
  const double exchanged = before + elastic0 + std::abs(outside) + std::abs(work);
  if (!(std::isfinite(loss) && loss >= -most_gain * exchanged - stage_.noise())) return false;
  lost_ = loss;
  for (const FreeMotion& each : step.equations.around.free) {  // energy that free bodies lost by the step itself
    const FreeState &from = step.from.free[each.index()], &end = stage_.free[each.index()];
    const auto [force, torque] = each.mean_loads(from, step.h);
    const double loads = force.dot(end.position - from.position) + 0.5 * step.h * torque.dot(each.spin(from) + each.spin(end));
    free_work_ -= loads - (each.kinetic_energy(end) - each.kinetic_energy(from));
  }
  exchange.work -= free_work_;
  exchange.dissipated -= free_work_;
  if (watch) {
    exchange.work += work + ramp_work;
    exchange.dissipated += loss;
  }
  return true;
}

void ImplicitContact::open(const Step& step) {
  alone_ = Isolated::is(step.equations);
  if (alone_) isolated_.begin(step.equations, step.from);
}

/// Adds the angular impulse of the outside torques at the present stage, which act for `weight` [s].
void ImplicitContact::add_torques(double weight) {
  if (alone_) isolated_.add(weight, stage_.force(), stage_.x, stage_.free);
}

/// Gives back the angular momentum that the step has lost.
void ImplicitContact::turn_back(bool watch, Exchange& exchange) {
  if (!alone_) return;
  const double given = isolated_.give_back(stage_.x, stage_.v, stage_.free);
  if (watch) exchange.dissipated -= given;
  lost_ -= given;
}

double ImplicitContact::kept(double angle) { return hypotenuse(1, (1 - 2 * gamma) * angle) / (1 + gamma * gamma * angle * angle); }

void ImplicitContact::take(State& state) {
  stage_.touches().hold(state);
  state.x.swap(stage_.x);
  state.v.swap(stage_.v);
  state.spring.swap(stage_.spring);
  state.free.swap(stage_.free);
}

}  // namespace softffd
