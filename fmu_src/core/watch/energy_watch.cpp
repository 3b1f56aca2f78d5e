#include "watch/energy_watch.hpp"

#include <algorithm>

#include "methods/traits.hpp"

namespace softffd {

namespace {

/// Work between two looks, in evaluations of the spring forces, without and with damping, which makes gains rare. A look costs about four.
constexpr double pause = 100, damped_pause = 400;

double kinetic_and_elastic(const Body& body, const State& state) {
  double kinetic = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (int p = 0; p < body.points(); ++p) kinetic += 0.5 * body.mass[p] * state.v(p, axis) * state.v(p, axis);
  return kinetic + body.elastic_energy(state.x);
}

double squared_forces(const Equations& equations, const State& state) {
  const auto& [body, around] = equations;
  double sum = 0;
  for (int i = 0; i < state.x.size(); ++i) {
    const double force = state.spring.data()[i] + around.force.data()[i] + (around.ramped ? around.ramp(i, state.time) : 0);
    sum += body.inverse_mass[i] * force * force;
  }
  return sum;
}

}  // namespace

void start(EnergyAccount& account, const Equations& equations, const State& state, double work) {
  account.kinetic_elastic = kinetic_and_elastic(equations.body, state);
  double exchanged = account.kinetic_elastic;  // including free bodies
  for (const FreeMotion& each : equations.around.free) exchanged += each.kinetic_energy(state.free[each.index()]);
  account.forces = squared_forces(equations, state);
  account.received = 0;
  account.largest = std::max(account.largest, exchanged);
  account.recent = std::max(account.recent, exchanged);
  account.due = work + (equations.body.damped ? damped_pause : pause);
}

void jolt(EnergyAccount& account, const Body& body, const Points& spring, const Points& before, const Points& after) {
  for (int i = 0; i < spring.size(); ++i) {
    const double old = spring.data()[i] + before.data()[i], now = spring.data()[i] + after.data()[i];
    account.forces += body.inverse_mass[i] * (now - old) * (now + old);
  }
}

void look(EnergyAccount& account, const Equations& equations, const State& state, double h, double work) {
  const double energy = account.kinetic_elastic, before = account.forces, given = account.received;
  if (++account.looks > late_looks) {
    account.earlier = account.recent;
    account.recent = 0;
    account.looks = 0;
  }
  start(account, equations, state, work);
  const double change = account.kinetic_elastic - energy - given - h * h / 8 * (account.forces - before);
  account.gained = std::max(account.gained + change, 0.0);  // NaN stays NaN
  account.balance += change;
}

/// True if the body is in windows between flights: there the energy that counts is another, which depends on the size of the steps.
bool between_flights(const Run& run) { return run.control.reason == Reason::impact; }

double staggered_step(const Run& run) { return traits(run.control.method).staggered ? run.physical.clock.h : 0; }

double lost(EnergyAccount account, const Equations& equations, const Run& run) {
  if (account.kinetic_elastic < 0) return 0;
  if (between_flights(run)) return -account.balance;
  look(account, equations, run.physical.motion, staggered_step(run), 0);
  return -account.balance;
}

double open_account(Run& now, const Run& before, const Model& model, const Drive& drive, bool changed, bool moved) {
  EnergyAccount& account = now.energy;
  const State &motion = now.physical.motion, &start_motion = before.physical.motion;
  const bool far = moved && (motion.x - start_motion.x).abs().maxCoeff() > far_jump * model.body.length;
  if (account.kinetic_elastic < 0 || changed || far) {
    start(account, {model.body, drive}, motion, now.control.work);
    return now.physical.exchange.work;
  }
  if (moved) account.received -= 0.5 * ((motion.spring + start_motion.spring) * (motion.x - start_motion.x)).sum();
  return 0;
}

void close_account(Run& now, const Model& model, const Drive& drive, const Points& begin, double booked) {
  EnergyAccount& account = now.energy;
  if (account.kinetic_elastic < 0 || now.control.method == Method::backward_euler ||
      now.control.method == Method::sdirk2) {  // it has its own guard
    account.kinetic_elastic = -1;
    return;
  }
  const Exchange& exchange = now.physical.exchange;
  const bool flew = now.control.reason == Reason::impact || now.control.reason == Reason::ringing_flight;
  const double taken = model.body.damped || flew ? 0 : exchange.dissipated;  // flights book it only for the outputs
  account.received += (drive.force * (now.physical.motion.x - begin)).sum() + exchange.work - booked - taken;
  if (now.control.work >= account.due && !between_flights(now))
    look(account, {model.body, drive}, now.physical.motion, staggered_step(now), now.control.work);
}

EnergyAccount account_at_start(const Run& before, const Model& model, const Drive& drive, bool changed) {
  EnergyAccount account = before.energy;
  if (changed || account.kinetic_elastic < 0 || between_flights(before)) return account;
  const State& motion = before.physical.motion;
  jolt(account, model.body, motion.spring, *before.outside, drive.force);
  look(account, {model.body, drive}, motion, staggered_step(before), 0);
  jolt(account, model.body, motion.spring, drive.force, *before.outside);
  return account;
}

}  // namespace softffd
