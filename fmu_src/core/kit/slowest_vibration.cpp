#include "kit/slowest_vibration.hpp"

#include <algorithm>

#include "matrix/stiffness_matrix.hpp"

namespace softffd {

namespace {

constexpr int iterations = 3;

}  // namespace

SlowestVibration::Room::Room(const Lattice& lattice)
    : rest(rest_positions(lattice)), mode(lattice.points(), 3), force(lattice.points(), 3), diagonal(lattice.points()), matrix(lattice) {}

double SlowestVibration::memory(const Body& body, double longest) {
  if (version_ != body.version || longest_ != longest) memory_ = find(body, longest);
  version_ = body.version;
  longest_ = longest;
  return memory_;
}

double SlowestVibration::find(const Body& body, double longest) {
  if (!room_) room_ = std::make_unique<Room>(lattice_);
  auto& [rest, mode, force, diagonal, matrix] = *room_;
  const double slight = 1 / (longest * longest);  // slower vibrations last longer
  diagonal = slight * body.mass;
  assemble(body, rest, {}, diagonal, matrix);
  matrix.factor();
  double memory = 0;
  for (int axis = 0; axis < 3; ++axis) {
    mode.setZero();
    for (int p = 0; p < body.points(); ++p) mode(p, axis) = body.pinned[p] ? 0 : 1;
    double squared = 0;
    for (int i = 0; i < iterations; ++i) {
      for (int a = 0; a < 3; ++a) force.col(a) = body.mass * mode.col(a);
      mode = force;
      matrix.solve(mode);
      const double kinetic = (mode.square().rowwise().sum() * body.mass).sum();
      squared = std::max(0.0, (mode * force).sum() / kinetic - slight);
      mode /= std::sqrt(kinetic);
    }
    const double power = (body.damping * mode.square().rowwise().sum()).sum() + body.dashpot_power(rest, mode), rate = 0.5 * power;
    if (!(rate * longest > 1 && squared * longest > 2 * rate)) return longest;
    memory = std::max({memory, 1 / rate, 2 * rate / squared});
  }
  return memory;
}

}  // namespace softffd
