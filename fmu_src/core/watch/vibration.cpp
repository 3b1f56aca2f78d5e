#include "watch/vibration.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "body/rigid_motion.hpp"
#include "model/arithmetic.hpp"

namespace softffd {

namespace {

constexpr double times = 2.5;

double outside_less_damping(const Equations& equations, const State& state, int i) {
  const auto& [body, around] = equations;
  const double ramp = around.ramped ? around.ramp(i, state.time) : 0;
  return around.force.data()[i] + ramp - body.damping[i % body.points()] * state.v.data()[i];
}

/// Returns the mean acceleration of a body without pins by the outside forces and its damping [m/s2].
Vec3 mean_acceleration(const Equations& equations, const State& state) {
  const Body& body = equations.body;
  Vec3 force = Vec3::Zero();
  for (int i = 0; i < 3 * body.points(); ++i) force[i / body.points()] += outside_less_damping(equations, state, i);
  return force / body.mass.sum();
}

double size(const Equations& equations, const State& state, const Scalars& time_scale, bool with_extension, double slowest,
            const Vec3& whole) {
  const Body& body = equations.body;
  const Points& inner = equations.inner(state.x, state.v, state.spring, body.scratch);
  const Swing by{time_scale, slowest, times, body.dashpots() ? body.shortest_time() : 0, with_extension};
  double amplitude = 0, sum = 0;  // largest and sum of the compared displacements
  const auto consider = [&](double size) {
    amplitude = std::max(amplitude, size);
    sum += size;
  };
  for (const auto& each : body.energies) consider(each->swing(state.x, state.v, by));
  for (int i = 0; i < time_scale.size(); ++i) {
    if (time_scale[i] >= slowest) continue;
    const double time = by.reach(time_scale[i]);
    const double a = body.inverse_mass[i] * (inner.data()[i] + outside_less_damping(equations, state, i));
    if (body.inverse_mass[i] > 0) consider(std::abs(a - whole[i / body.points()]) * time * time);
  }
  return std::isfinite(sum) ? 2 * amplitude : std::numeric_limits<double>::infinity();
}

/// Returns the rigid motion that vibrations are relative to: that of the body, or of the pin that holds it.
RigidMotion carrier(const Equations& equations, const State& state) {
  if (equations.around.pins.empty()) return rigid_motion(equations.body.mass, state.x, state.v);
  const Frame frame = equations.around.pins.front().at(state.time);
  return {frame.origin, frame.velocity, frame.spin};
}

void subtract(const Body& body, const RigidMotion& rigid, const Points& x, Points& u) {
  for (int p = 0; p < body.points(); ++p)
    set_row(u, p, body.pinned[p] ? Vec3::Zero() : Vec3(row(u, p) - rigid.velocity - rigid.spin.cross(row(x, p) - rigid.centre)));
}

/// Angular frequency of a vibration of shape u, by Rayleigh's quotient [rad/s].
double frequency(const Body& body, const Points& x, const Points& u, Points& f) {
  f.setZero();
  body.subtract_product(x, {}, u, f);
  const double inertia = (body.mass * u.square().rowwise().sum()).sum();
  return inertia > 0 ? std::sqrt(std::max(0.0, -(u * f).sum() / inertia)) : 0;
}

}  // namespace

double vibration(const Equations& equations, const State& state, const Scalars& time_scale) {
  return size(equations, state, time_scale, true, std::numeric_limits<double>::infinity(), Vec3::Zero());
}

double may_set_off(const Model& model, const Drive& drive, const Points& before, double H) {
  if (drive.bent) return std::numeric_limits<double>::infinity();
  double most = 0;
  for (Eigen::Index i = 0; i < before.size(); ++i) {
    const double change =
        std::abs(drive.force.data()[i] - before.data()[i]) + (drive.ramped ? std::abs(H * drive.force_rate.data()[i]) : 0);
    if (change > 0) most = worse(most, change * model.body.inverse_mass[i] * (times * model.time_scale[i]) * (times * model.time_scale[i]));
  }
  return 2 * most;
}

double coming_vibration(const Equations& equations, State& state, const Scalars& time_scale, double left) {
  const double now = vibration(equations, state, time_scale);
  if (!equations.around.ramped) return now;
  const double begin = std::exchange(state.time, state.time + left);
  const double then = vibration(equations, state, time_scale);
  state.time = begin;
  return std::max(now, then);
}

double present_vibration(const Equations& equations, const State& state, const Scalars& time_scale, double slowest) {
  const bool held = !equations.around.pins.empty();
  return size(equations, state, time_scale, false, slowest, held ? Vec3::Zero() : mean_acceleration(equations, state));
}

double amplitude(const Model& model, double energy, double slowest) {
  double total = 0, weighted = 0;
  for (int p = 0; p < model.body.points(); ++p) {
    const double time = std::min(slowest, model.time_scale[p]);
    total += model.body.mass[p];
    weighted += model.body.mass[p] * time * time;
  }
  return std::sqrt(2 * energy * weighted) / total;
}

Vibration set_off(const Equations& equations, const State& start, const State& end, double kink, Points& jump, Points& u) {
  const auto& [body, around] = equations;
  Vibration largest;
  const auto consider = [&](int order) {
    const double omega = frequency(body, start.x, u, jump), amplitude = kernels::largest(u.size(), u.data()) / power(omega, order);
    if (omega > 0 && amplitude > largest.amplitude) largest = {amplitude, omega};
  };
  for (int i = 0; i < u.size(); ++i) u(i) = body.inverse_mass[i] * jump(i);
  if (around.pins.empty()) subtract(body, rigid_motion(body.mass, start.x, u), start.x, u);
  consider(2);
  jump = start.v;
  subtract(body, carrier(equations, start), start.x, jump);
  u = end.v;
  subtract(body, carrier(equations, end), end.x, u);
  u = kink * (u - jump);
  consider(1);
  return largest;
}

}  // namespace softffd
