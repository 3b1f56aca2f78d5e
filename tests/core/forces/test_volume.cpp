#include "forces/volume.hpp"

#include <cstring>

#include "bodies.hpp"
#include "body/stability.hpp"
#include "check.hpp"
#include "derivatives.hpp"

using namespace softffd;

namespace {

constexpr double kappa = 9e3;

Body filled_body(const Lattice& lattice, double k) {
  Body body = even_body(lattice, k);
  body.energies.push_back(std::make_shared<Volume>(lattice, kappa));
  return body;
}

}  // namespace

TEST(nothing_happens_before_a_corner_has_lost_half_its_volume) {
  const Lattice lattice;
  const Volume volume(lattice, kappa);
  const Scalars mass = Scalars::Ones(64);
  const std::vector<bool> pinned(64, false);
  for (const Points& x : {rest_positions(lattice), scattered(lattice, 0.03), Points(3.0 * rest_positions(lattice))}) {
    Points f = scattered(lattice, 1.0), before = f;
    f(5, 1) = before(5, 1) = -0.0;
    Scalars sums = Scalars::Ones(6 * 64);
    volume.add_force(x, f);
    CHECK(std::memcmp(f.data(), before.data(), f.size() * sizeof(double)) == 0);
    CHECK(volume.energy(x) == 0);
    CHECK(!volume.add_bounds(x, mass, pinned, sums) && (sums == 1).all());
  }
}

TEST(energy_of_a_flattened_box_is_the_formula) {
  const Lattice lattice{{3, 4, 2}, Vec3::Zero(), {2, 1, 0.5}};
  Points x = rest_positions(lattice);
  x.col(2) *= 0.2;
  CHECK_NEAR(Volume(lattice, kappa).energy(x), kappa * (2 * 1 * 0.5) * std::pow(0.5 - 0.2, 3) / (3 * 0.5), 1e-11);
}

TEST(volume_force_is_minus_the_gradient_of_the_energy) {
  for (const Lattice& lattice : {Lattice{}, Lattice{{2, 3, 5}, Vec3::Zero(), {1, 0.7, 2}}}) {
    const Volume volume(lattice, 1.0);
    const Points x = scattered(lattice, 0.2);
    Points f = Points::Zero(x.rows(), 3);
    volume.add_force(x, f);
    CHECK(f.abs().maxCoeff() > 0.01);
    CHECK_NEAR(distance(f, -gradient(x, [&](const Points& at) { return volume.energy(at); })), 0.0, 1e-8);
  }
}

TEST(forces_and_their_moments_add_up_to_nothing) {
  const Points x = scattered(Lattice{}, 0.3);
  Points f = Points::Zero(64, 3);
  Volume(Lattice{}, 1.0).add_force(x, f);
  const double size = f.abs().maxCoeff();
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    CHECK_NEAR(f.col(a).sum(), 0.0, 1e-14 * 64 * size);
    CHECK_NEAR((x.col(b) * f.col(c) - x.col(c) * f.col(b)).sum(), 0.0, 1e-14 * 64 * size);
  }
}

TEST(a_body_at_one_place_and_one_without_size_have_finite_forces) {
  Points f = Points::Zero(64, 3);
  Volume(Lattice{}, kappa).add_force(Points::Zero(64, 3), f);
  CHECK((f == 0).all());
  const Lattice tiny{{4, 4, 4}, Vec3::Zero(), Vec3::Constant(1e-60)};
  Points x = rest_positions(tiny);
  x.col(2) *= 0.1;
  Volume(tiny, kappa).add_force(x, f);
  CHECK(f.isFinite().all());
}

TEST(stability_bound_holds_whatever_the_shape_masses_and_pins) {
  int crushed = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const Lattice lattice{{3, 4, 2}, Vec3::Zero(), {1, 1.5, 0.6}};
    Body body = filled_body(lattice, trial % 3 ? 0 : 500);
    Points x = scattered(lattice, 0.1 + 0.02 * trial, trial);
    if (trial % 4 == 1) x.col(2) *= 0.3;
    if (trial % 4 == 2) x.col(0) *= -2;
    for (int p = 0; trial % 5 && p < body.points(); ++p) body.mass[p] = std::pow(10.0, 4 * scattered(7 * trial + p) - 3);
    if (trial % 2) body.pinned[trial % 24] = body.pinned[2 * trial % 24] = true;
    Stability stability(body.points());
    stability.prepare(body);
    const double bound = stability.frequency(body, x);
    CHECK(stability.elastic() && bound >= highest_frequency(body, x) * (1 - 1e-6));
    Scalars sums = Scalars::Zero(6 * 24);
    crushed += body.energies.back()->add_bounds(x, body.mass, body.pinned, sums);
  }
  CHECK(crushed > 30);
}

TEST(bound_is_sharp_where_one_corner_alone_gives_way) {
  const Lattice lattice{{2, 2, 2}};
  Body body = filled_body(lattice, 0);
  Points x = rest_positions(lattice);
  x.row(0) = 0.168;  // J = 0.496 at this corner, 0.83 and more at all others
  const Cells::Corner corner = Cells(lattice).corner(x, 0, 0, 0, 0);
  for (int i = 0; i < 4; ++i) body.mass[corner.points[i]] = corner.gradient[i].squaredNorm();  // all points take equal parts then
  Stability stability(8);
  stability.prepare(body);
  CHECK_NEAR(stability.frequency(body, x) / highest_frequency(body, x), 1.003, 0.003);  // phi' is 250 times smaller than phi''
}

TEST(bound_of_a_crushed_uniform_box_is_sharp_enough_to_use) {
  const Body body = filled_body({}, 1e3);
  Stability stability(64);
  stability.prepare(body);
  CHECK(stability.frequency(body, rest_positions({})) <= 1.21 * 930.848018037389);  // as without the term
  for (double height : {0.45, 0.2, 0.05}) {
    Points x = scattered(Lattice{}, 0.02);
    x.col(2) *= height;
    const double truth = highest_frequency(body, x), bound = stability.frequency(body, x);
    CHECK(bound >= truth && bound <= 2.2 * truth);
  }
}
