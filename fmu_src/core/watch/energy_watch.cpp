#include "watch/energy_watch.hpp"

#include <algorithm>

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

void EnergyWatch::start(const Equations& equations, const State& state, double work) {
  kinetic_elastic = kinetic_and_elastic(equations.body, state);
  forces = squared_forces(equations, state);
  received = 0;
  largest = std::max(largest, kinetic_elastic);
  due = work + (equations.body.damped ? damped_pause : pause);
}

void EnergyWatch::jolt(const Body& body, const Points& spring, const Points& before, const Points& after) {
  for (int i = 0; i < spring.size(); ++i) {
    const double old = spring.data()[i] + before.data()[i], now = spring.data()[i] + after.data()[i];
    forces += body.inverse_mass[i] * (now - old) * (now + old);
  }
}

void EnergyWatch::look(const Equations& equations, const State& state, double h, double work) {
  const double energy = kinetic_elastic, before = forces, given = received;
  start(equations, state, work);
  const double change = kinetic_elastic - energy - given - h * h / 8 * (forces - before);
  gained = std::max(0.0, gained + change);
  balance += change;
}

}  // namespace softffd
