#include "body/model.hpp"

#include <limits>

#include "model/arithmetic.hpp"

namespace softffd {

namespace {

/// Displacements below this value, relative to the box, are rounding [1].
constexpr double slight = 1e-9;

}  // namespace

Model::Model(Body of)
    : body(std::move(of)), stability(body.points()), time_scale(Scalars::Zero(3 * body.points())), memory(3 * body.points()) {}

void Model::renew() {
  const int n = body.points();
  ++body.version;
  body.damped = (body.damping > 0).any() || body.dashpots();
  body.inverse_mass.resize(3 * n);
  body.damping_rate.resize(3 * n);
  for (int i = 0; i < 3 * n; ++i) {
    const int p = i % n;
    body.inverse_mass[i] = body.pinned[p] ? 0 : 1 / body.mass[p];
    body.damping_rate[i] = body.pinned[p] ? 0 : body.damping[p] / body.mass[p];
  }
  noise = 0;
  for (const auto& each : body.energies) noise += 0.5 * each->total_stiffness() * power(slight * body.length, 2);
  stability.prepare(body);
  stability.time_scales(body, time_scale);
  body.fastest_damping = body.fastest_drag = body.damping_rate.maxCoeff();
  if (body.dashpots()) body.fastest_damping += body.longest_time() * power(stability.any_frequency(), 2);
  for (int i = 0; i < 3 * n; ++i) memory[i] = body.damping_rate[i] > 0 ? 2 / body.damping_rate[i] : std::numeric_limits<double>::infinity();
  longest_memory = memory.maxCoeff();
}

}  // namespace softffd
