#include "matrix/slowest_vibration.hpp"

#include <algorithm>

#include "matrix/stiffness_matrix.hpp"

namespace softffd {

namespace {

constexpr int iterations = 3;

}  // namespace

double memory_of_slowest_vibration(const Lattice& lattice, const Body& body, double longest) {
  const Points rest = rest_positions(lattice);
  const double slight = 1 / (longest * longest);  // what is slower lasts longer
  Scalars sums(6 * body.points());
  LatticeMatrix matrix(lattice);
  assemble(body, rest, slight * body.mass, sums, matrix);
  matrix.factor();
  double memory = 0;
  for (int axis = 0; axis < 3; ++axis) {
    Points mode = Points::Zero(body.points(), 3), force = mode;
    for (int p = 0; p < body.points(); ++p) mode(p, axis) = body.pinned[p] ? 0 : 1;
    double squared = 0, kinetic = 0;
    for (int i = 0; i < iterations; ++i) {
      for (int a = 0; a < 3; ++a) force.col(a) = body.mass * mode.col(a);
      mode = force;
      matrix.solve(mode);
      kinetic = (mode.square().rowwise().sum() * body.mass).sum();
      squared = std::max(0.0, (mode * force).sum() / kinetic - slight);
      mode /= std::sqrt(kinetic);
    }
    const double power = (body.damping * mode.square().rowwise().sum()).sum() + dashpot_power(body.springs, rest, mode), rate = 0.5 * power;
    if (!(rate * longest > 1 && squared * longest > 2 * rate)) return longest;
    memory = std::max({memory, 1 / rate, 2 * rate / squared});
  }
  return memory;
}

}  // namespace softffd
