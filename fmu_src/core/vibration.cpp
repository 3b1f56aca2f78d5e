#include "vibration.hpp"

#include <algorithm>

namespace softffd {

namespace {

double size(const Equations& equations, const State& state, const Scalars& time_scale, bool with_extension) {
  constexpr double times = 2.5;
  const Body& body = equations.body;
  double amplitude = 0;
  for (const Springs::Row& springs : body.springs.rows())
    for (int lane = 0; lane < springs.lanes(); ++lane) {
      if (springs.stiffness[lane] == 0) continue;
      const int p = springs.begin + lane, q = p + springs.offset;
      const Vec3 d = row(state.x, q) - row(state.x, p), w = row(state.v, q) - row(state.v, p);
      const double r = d.norm(), time = times * std::min(time_scale[p], time_scale[q]);
      if (with_extension) amplitude = std::max(amplitude, std::abs(r - springs.rest_length[lane]));
      if (r > 0) amplitude = std::max({amplitude, std::abs(d.dot(w)) / r * time, w.squaredNorm() / r * time * time});
    }
  const double age = equations.around.ramped ? state.time - equations.around.since : 0;
  for (int i = 0; i < time_scale.size(); ++i) {
    const double time = times * time_scale[i], outside = equations.around.force.data()[i] + age * equations.around.force_rate.data()[i];
    const double a = body.inverse_mass[i] * (state.spring.data()[i] + outside) - body.damping_rate[i] * state.v.data()[i];
    amplitude = std::max(amplitude, std::abs(a) * time * time);
  }
  return 2 * amplitude;
}

}  // namespace

double vibration(const Equations& equations, const State& state, const Scalars& time_scale) {
  return size(equations, state, time_scale, true);
}

double present_vibration(const Equations& equations, const State& state, const Scalars& time_scale) {
  return size(equations, state, time_scale, false);
}

}  // namespace softffd
