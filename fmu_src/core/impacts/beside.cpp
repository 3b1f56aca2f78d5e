#include "impacts/beside.hpp"

namespace softffd {

double energy_lost(const StepContext& context, const State& from, double given) {
  const Body& body = context.model.body;
  const State& to = context.run.physical.motion;
  const double h = to.time - from.time, middle = 0.5 * (from.time + to.time);
  double sum = given + body.elastic_energy(from.x) - body.elastic_energy(to.x);
  for (int axis = 0; axis < 3; ++axis)
    for (int p = 0; p < body.points(); ++p) {
      const double mean = 0.5 * (from.v(p, axis) + to.v(p, axis)), change = to.v(p, axis) - from.v(p, axis);
      const double force = context.drive.force(p, axis) + (context.drive.ramped ? context.drive.ramp(p + axis * body.points(), middle) : 0);
      sum += force * (to.x(p, axis) - from.x(p, axis)) - body.damping[p] * h * mean * mean - body.mass[p] * mean * change;
    }
  return sum;
}

void book_energies(const StepContext& context, const State& from, const Points& booked, const Exchange& before) {
  const Body& body = context.model.body;
  const State& to = context.run.physical.motion;
  Exchange& exchange = context.run.physical.exchange;
  if (context.drive.ramped) exchange.work += context.drive.ramp_dot(0.5 * (from.time + to.time), to.x - booked);
  double balance = exchange.work - before.work + body.elastic_energy(from.x) - body.elastic_energy(to.x);
  for (int axis = 0; axis < 3; ++axis)
    for (int p = 0; p < body.points(); ++p) {
      const double mean = 0.5 * (from.v(p, axis) + to.v(p, axis)), change = to.v(p, axis) - from.v(p, axis);
      balance += context.drive.force(p, axis) * (to.x(p, axis) - from.x(p, axis)) - body.mass[p] * mean * change;
    }
  exchange.dissipated = before.dissipated + balance;
}

}  // namespace softffd
