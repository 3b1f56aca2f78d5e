#include "kit/slowest_vibration.hpp"

#include <Eigen/Eigenvalues>

#include "bodies.hpp"
#include "check.hpp"

using namespace softffd;

namespace {

/// A bar held at its left end, of 1 kg and springs of 1e4 N/m with internal damping tau [s].
Body bar(const Lattice& lattice, double tau) {
  Body body = even_body(lattice, 1e4);
  springs_of(body).set_dashpots(tau);
  for (int p = 0; p < lattice.points(); ++p) body.pinned[p] = p % lattice.counts[0] == 0;
  return body;
}

/// Frequency of the slowest of all vibrations [rad/s], by a dense solver.
double slowest(const Lattice& lattice, const Body& body) {
  const int n = lattice.points();
  const Points rest = rest_positions(lattice);
  Eigen::MatrixXd stiffness(3 * n, 3 * n);
  Points unit = Points::Zero(n, 3), force = unit;
  for (int i = 0; i < 3 * n; ++i) {
    unit.setZero();
    unit.data()[i] = body.pinned[i % n] ? 0 : 1;
    force.setZero();
    body.subtract_product(rest, {}, unit, force);
    for (int j = 0; j < 3 * n; ++j) stiffness(j, i) = body.pinned[j % n] ? 0 : -force.data()[j];
    if (body.pinned[i % n]) stiffness(i, i) = 1e12;
  }
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(stiffness).eigenvalues()[0] / body.mass[0]);
}

double memory(const Lattice& lattice, const Body& body, double longest) { return SlowestVibration(lattice).memory(body, longest); }

}  // namespace

TEST(it_lasts_as_long_as_the_slowest_vibration) {
  for (const Lattice& lattice : {Lattice{{9, 2, 2}, Vec3::Zero(), {0.8, 0.05, 0.1}}, Lattice{{4, 4, 4}}, Lattice{{2, 3, 5}}})
    for (const double tau : {1e-5, 1e-3}) {
      const Body body = bar(lattice, tau);
      const double squared = std::pow(slowest(lattice, body), 2);
      CHECK_NEAR(memory(lattice, body, 1e9) / (2 / (tau * squared)), 1, 0.02);
    }
}

TEST(where_damping_is_strong_it_lasts_as_long_as_the_creep) {
  const Lattice lattice{{4, 4, 4}};
  CHECK_NEAR(memory(lattice, bar(lattice, 10), 1e9), 10, 1e-3);
}

TEST(without_damping_or_where_nothing_takes_it_back_it_lasts_for_ever) {
  const Lattice lattice{{3, 3, 3}};
  CHECK(memory(lattice, bar(lattice, 0), 7) == 7);
  Body hinged = bar(lattice, 1e-3);
  for (int p = 0; p < lattice.points(); ++p) hinged.pinned[p] = p == 0;
  CHECK(memory(lattice, hinged, 7) == 7);
}
