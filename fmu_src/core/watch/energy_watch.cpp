#include "watch/energy_watch.hpp"

#include <algorithm>

#include "methods/traits.hpp"

namespace softffd {

namespace {

/// Work between two looks, in evaluations of the spring forces; a look costs about four. Damping makes gains rare.
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
  account.forces = squared_forces(equations, state);
  account.received = 0;
  account.largest = std::max(account.largest, account.kinetic_elastic);
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
  start(account, equations, state, work);
  const double change = account.kinetic_elastic - energy - given - h * h / 8 * (account.forces - before);
  account.gained = std::max(0.0, account.gained + change);
  account.balance += change;
}

double staggered_step(const Run& run) { return traits(run.course.method).staggered ? run.path.clock.h : 0; }

double lost(EnergyAccount account, const Equations& equations, const Run& run) {
  if (account.kinetic_elastic < 0) return 0;
  look(account, equations, run.path.motion, staggered_step(run), 0);
  return -account.balance;
}

}  // namespace softffd
