/// The finite element against closed forms, and against another program: frequencies of a cube of side 1, Young's modulus 1 and density 1
/// by hp-refined grids to six digits. Deflections are read through the FMU (tests/system/solid/test_at_rest.py).
#include "forces/solid.hpp"

#include "bodies.hpp"
#include "body/model.hpp"
#include "check.hpp"
#include "derivatives.hpp"
#include "matrix/stiffness_matrix.hpp"
#include "model/basis.hpp"
#include "model/lobatto.hpp"

using namespace softffd;

namespace {

Lattice cube(int n) { return {.counts = {n, n, n}, .lobatto = true}; }
const Lattice long_box{.counts = {7, 4, 4}, .size = {2, 0.7, 1.1}, .lobatto = true};

/// Of density 1.
Body solid_body(const Lattice& lattice, double ratio = 0.25, double modulus = 1, double time = 0) {
  const int n = lattice.points();
  Body body{.energies = {},
            .mass = lobatto::volume_fractions(lattice) * lattice.size.prod(),
            .damping = Scalars::Zero(n),
            .pinned = std::vector<bool>(n, false)};
  auto solid = std::make_shared<Solid>(lattice);
  solid->set_material(modulus, ratio, time);
  body.energies.push_back(solid);
  body.length = lattice.largest_side();
  return body;
}

/// The rest shape with F = diag(s, t, t) and a shear of x by z.
Points homogeneous(const Lattice& lattice, double s, double t, double shear = 0) {
  Points x = rest_positions(lattice);
  const Scalars z = x.col(2);
  x.col(0) = s * x.col(0) + shear * z;
  x.col(1) *= t;
  x.col(2) *= t;
  return x;
}

/// Of uniaxial stress at modulus 1: sides t from mu t + (mu (J - 2) + lambda (J - 1)) s t = 0, J = s t^2, and P = mu s + (..) t^2.
struct Uniaxial {
  double side, stress;
  Uniaxial(double ratio, double s) {
    const double mu = 1 / (2 * (1 + ratio)), lambda = ratio / ((1 + ratio) * (1 - 2 * ratio));
    const double volume = (2 * mu + lambda - mu / s) / (mu + lambda);
    side = std::sqrt(volume / s);
    stress = mu * s + (mu * (volume - 2) + lambda * (volume - 1)) * side * side;
  }
};

Eigen::MatrixXd products(const Body& body, const Points& x, double per_time = 0, double softening = 1) {
  return -matrix_of(body.points(),
                    [&](const Points& u, Points& f) { body.subtract_product(x, {.softening = softening, .per_time = per_time}, u, f); });
}

/// Frequencies of the body at rest [rad/s], the least first.
Eigen::VectorXd frequencies(const Body& body, const Lattice& lattice) {
  Eigen::MatrixXd k = products(body, rest_positions(lattice));
  for (int i = 0; i < k.rows(); ++i)
    for (int j = 0; j < k.cols(); ++j) k(i, j) /= std::sqrt(body.mass[i % body.points()] * body.mass[j % body.points()]);
  return dense::eigenvalues(0.5 * (k + k.transpose())).cwiseMax(0).cwiseSqrt();
}

}  // namespace

TEST(at_rest_and_after_a_rigid_motion_a_solid_has_no_forces) {
  for (const double ratio : {0.25, 0.45, 0.49}) {
    const double modulus = 1e4;
    const Body body = solid_body(long_box, ratio, modulus, 1e-2);
    Points x = rest_positions(long_box), f = x;
    body.internal_force(x, f);
    CHECK(f.abs().maxCoeff() < 1e-15 * modulus);
    Eigen::Matrix3d turn = (Eigen::AngleAxisd(0.8, Vec3(1, 2, -1).normalized())).toRotationMatrix();
    for (int p = 0; p < x.rows(); ++p) set_row(x, p, Vec3(turn * row(x, p) + Vec3(3, -1, 2)));
    body.internal_force(x, f);
    CHECK(f.abs().maxCoeff() < 1e-13 * modulus);
    for (const Points& shape : {x, scattered(long_box, 0.05)}) {  // a deformed body spins without loss too
      Points v = shape, of_spin = Points::Zero(x.rows(), 3), ordinary = of_spin;
      for (int p = 0; p < x.rows(); ++p) set_row(v, p, Vec3(Vec3(1, -2, 0.5).cross(row(shape, p)) + Vec3(1, 2, 3)));
      body.add_dashpot_force(shape, v, of_spin);
      body.add_dashpot_force(shape, scattered(long_box, 1, 4), ordinary);
      CHECK(of_spin.abs().maxCoeff() < std::min(1e-10, 1e-13 * ordinary.abs().maxCoeff()));
      CHECK(body.dashpot_power(shape, v) < 1e-13 * body.dashpot_power(shape, scattered(long_box, 1, 4)));
    }
  }
}

TEST(forces_are_the_slope_of_the_energy_and_products_those_of_the_forces) {
  for (const auto& [ratio, amplitude] : check::each_with<double, double>({0.25, 0.4, 0.45, 0.49}, {0.02, 0.25})) {
    const Body body = solid_body(long_box, ratio, 10);
    const Points x = scattered(long_box, amplitude);  // at 0.25 some nodes are crushed and turned inside out
    Points f = x;
    body.internal_force(x, f);
    const Points slope = gradient(x, [&](const Points& at) { return body.elastic_energy(at); });
    CHECK(distance(f, -slope) < 1e-8 * f.abs().maxCoeff());
    const Eigen::MatrixXd exact = stiffness_by_differences(x, [&](const Points& at, Points& g) { body.internal_force(at, g); });
    const Eigen::MatrixXd k = products(body, x);
    CHECK(largest(exact - k) < 1e-6 * largest(k));
    CHECK(largest(k - k.transpose()) < 1e-12 * largest(k));
  }
}

TEST(blocks_are_the_products_matrix) {
  struct Dense : BlockSink {
    Eigen::MatrixXd k = Eigen::MatrixXd::Zero(3 * 112, 3 * 112);
    void add(int p, int q, const Mat3& block) override {
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) {
          k(p + 112 * a, q + 112 * b) += block(a, b);
          if (p != q) k(q + 112 * b, p + 112 * a) += block(a, b);
        }
    }
  } sink;
  const Body body = solid_body(long_box, 0.4, 10, 0.02);
  const Points x = scattered(long_box, 0.05);
  body.energies.front()->add_blocks(x, {.softening = 1, .per_time = 30}, sink);
  const Eigen::MatrixXd k = products(body, x, 30);
  CHECK(largest(sink.k - k) < 1e-12 * largest(k));
}

TEST(without_softening_the_matrix_is_positive_semidefinite_and_at_rest_nearly_the_whole) {
  for (const double ratio : {0.0, 0.3, 0.49})
    for (int trial = 0; trial < 6; ++trial) {
      const Body body = solid_body(cube(4), ratio);
      const Points x = trial == 0   ? homogeneous(cube(4), 0.5, 1)
                       : trial == 1 ? homogeneous(cube(4), 1.5, 1.2)
                                    : scattered(cube(4), 0.02 * trial, trial);
      const Eigen::MatrixXd k = products(body, x, 0, 0);
      CHECK(dense::eigenvalues(k).minCoeff() > -1e-13 * largest(k));
    }
  const Body body = solid_body(long_box, 0.4);
  CHECK(largest(products(body, rest_positions(long_box)) - products(body, rest_positions(long_box), 0, 0)) < 1e-7);
}

TEST(a_solid_has_a_factor_whose_solutions_are_those_of_its_matrix) {
  for (const Lattice& lattice : {cube(4), long_box, Lattice{.counts = {4, 7, 10}, .size = {1, 2, 2}, .lobatto = true}}) {
    Body body = solid_body(lattice, 0.4, 10, 0.02);
    body.pinned[5] = true;
    const Points x = scattered(lattice, 0.02), wanted = scattered(lattice, 1, 3);
    LatticeMatrix matrix(lattice);
    assemble(body, x, {.per_time = 20}, Scalars::Constant(lattice.points(), 3), matrix);
    Points b = 3 * wanted, product = Points::Zero(b.rows(), 3), u = wanted;
    set_row(u, 5, Vec3::Zero());
    body.subtract_product(x, {.per_time = 20}, u, product);
    b -= product;
    set_row(b, 5, row(wanted, 5));
    matrix.factor();
    matrix.solve(b);
    CHECK(distance(b, wanted) < 1e-10);
  }
}

TEST(stretch_and_shear_have_their_closed_forms) {
  CHECK_NEAR(Uniaxial(0.45, 0.5).stress, -1.068965517, 1e-9);
  CHECK_NEAR(Uniaxial(0.45, 2).stress, 0.599137931, 1e-9);
  for (const auto& [ratio, s] : check::each_with<double, double>({0, 0.25, 0.45, 0.49}, {0.5, 0.7, 1.5, 2})) {
    const Body body = solid_body(long_box, ratio);
    const Uniaxial exact(ratio, s);
    const Points x = homogeneous(long_box, s, exact.side);
    Points f = x;
    body.internal_force(x, f);
    double pull = 0, inside = 0;
    for (int p = 0; p < x.rows(); ++p) {
      if (p % 7 == 6) pull -= f(p, 0);
      if (p % 7 > 0 && p % 7 < 6) inside = std::max(inside, row(f, p).norm());
    }
    CHECK_NEAR(pull / (0.7 * 1.1), exact.stress, 1e-9);
    CHECK(inside < 1e-14);
  }
  const Body body = solid_body(long_box, 0.3);
  const double mu = 1 / 2.6, shear = 0.8;
  const Points x = homogeneous(long_box, 1, 1, shear);
  CHECK_NEAR(body.elastic_energy(x), 0.5 * mu * shear * shear * long_box.size.prod(), 1e-13);
  Points f = x;
  body.internal_force(x, f);
  double across = 0, normal = 0;
  for (int p = 84; p < 112; ++p) across -= f(p, 0), normal -= f(p, 2);
  CHECK_NEAR(across / (2 * 0.7), mu * shear, 1e-13);
  CHECK(std::abs(normal) < 1e-13);
}

TEST(a_free_solid_vibrates_as_the_continuum_does) {
  struct Case {
    Lattice lattice;
    double ratio, first, percent, highest;
  };
  const Lattice bar{.counts = {13, 4, 4}, .size = {4, 1, 1}, .lobatto = true};
  std::vector<Case> cases{{cube(4), 0.25, 1.80619, 0.26, 12.7},
                          {cube(4), 0.49, 1.65488, 0.23, 54.8},
                          {cube(7), 0.25, 1.80619, 0.11, 24.1},
                          {bar, 0.25, 0.33994, 0.04, 12.4}};
  if (check::thorough)
    for (const Case& each :
         {Case{cube(7), 0.45, 1.67746, 0.10, 42.8}, Case{cube(7), 0.49, 1.65488, 0.09, 94.4}, Case{bar, 0.45, 0.33741, 0.04, 23.5}})
      cases.push_back(each);
  for (const Case& each : cases) {
    const Eigen::VectorXd found = frequencies(solid_body(each.lattice, each.ratio), each.lattice);
    CHECK(found[5] < 1e-6);
    CHECK_NEAR(100 * (found[6] / each.first - 1), each.percent, 0.01);
    CHECK_NEAR(found[found.size() - 1], each.highest, 0.006 * each.highest);
  }
}

TEST(the_bound_of_the_frequency_holds_in_every_shape_and_is_near) {
  struct Shape {
    Points x;
    double most;  ///< times the truth
  };
  for (const auto& [n, ratio] : check::each_with<int, double>({4, 7}, {0.25, 0.45, 0.49})) {
    const Lattice lattice = cube(n);
    const Points rest = rest_positions(lattice);
    Points bent = rest, mirrored = rest, flat = rest;
    for (int p = 0; p < rest.rows(); ++p) {
      const double angle = 1.2 * rest(p, 0), radius = 1 / 1.2 - (rest(p, 2) - 0.5);
      bent(p, 0) = radius * std::sin(angle);
      bent(p, 2) = 1 / 1.2 - radius * std::cos(angle);
    }
    mirrored.col(0) *= -1;
    flat.col(0) *= 1e-3;
    const Shape shapes[] = {{rest, ratio < 0.3 ? 1.3 : 1.15},
                            {homogeneous(lattice, 1.5, 0.85), 1.6},
                            {homogeneous(lattice, 2, 0.72), 1.6},
                            {homogeneous(lattice, 1, 1, 0.8), 1.6},
                            {bent, 2.1},
                            {homogeneous(lattice, 0.3, 1.3), 2.1},
                            {scattered(lattice, 0.03 / (n - 1)), 1.7},
                            {scattered(lattice, 0.3 / (n - 1)), 2.9},
                            {mirrored, 1.8},
                            {flat, 2}};
    for (const Shape& shape : shapes) {
      const Body body = solid_body(lattice, ratio, 1, 1);
      Stability stability(body.points());
      stability.prepare(body);
      const auto stiffness = [&](const Points& u, Points& f) { body.subtract_product(shape.x, {.softening = 1}, u, f); };
      const double bound = stability.frequency(body, shape.x), truth = std::sqrt(largest_eigenvalue(body, stiffness));
      // it is that of the worst patch, and eight together vibrate more slowly than the fastest of them alone
      CHECK(bound >= truth * (1 - 1e-6) && bound <= shape.most * (n == 4 ? 1 : 1.1) * truth);
      const double rate = largest_eigenvalue(body, [&](const Points& v, Points& f) { body.add_dashpot_force(shape.x, v, f); });
      CHECK(body.damping_rate_at(shape.x) >= rate * (1 - 1e-9));
    }
  }
}

TEST(the_bound_does_not_depend_on_how_the_body_is_turned) {
  const Body body = solid_body(cube(4), 0.25, 1, 1);
  const Points rest = rest_positions(cube(4));
  Stability stability(64);
  stability.prepare(body);
  const double frequency = stability.frequency(body, rest), rate = body.damping_rate_at(rest);
  for (int trial = 0; trial < 300; ++trial) {
    const Vec3 axis(scattered(3 * trial), scattered(3 * trial + 1), scattered(3 * trial + 2));
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.02 * trial, axis.normalized()).toRotationMatrix();
    Points x = rest;
    for (int p = 0; p < 64; ++p) set_row(x, p, Vec3(turn * row(rest, p)));
    CHECK_NEAR(stability.frequency(body, x), frequency, 1e-6 * frequency);
    CHECK_NEAR(body.damping_rate_at(x), rate, 1e-6 * rate);
  }
}

TEST(the_bound_holds_whatever_the_masses_and_pins_of_several_patches) {
  for (int trial = 0; trial < 6; ++trial) {
    Body body = solid_body(long_box, 0.4, 20);
    for (int p = 0; p < body.points(); ++p) body.mass[p] *= std::pow(10.0, 2 * scattered(7 * trial + p) - 1);
    if (trial % 2) body.pinned[trial] = body.pinned[2 * trial] = true;
    const Points x = scattered(long_box, 0.03 * trial, trial);
    Stability stability(body.points());
    stability.prepare(body);
    CHECK(stability.frequency(body, x) >= highest_frequency(body, x) * (1 - 1e-6));
  }
}

TEST(internal_damping_is_a_time_times_the_stiffness_at_rest) {
  const Body body = solid_body(long_box, 0.4, 10, 0.02);
  const Points rest = rest_positions(long_box);
  const Eigen::MatrixXd c = -matrix_of(112, [&](const Points& v, Points& f) { body.add_dashpot_force(rest, v, f); });
  CHECK(largest(c - 0.02 * products(body, rest)) < 1e-13 * largest(c) * 112);
  const Points x = scattered(long_box, 0.1), v = scattered(long_box, 1, 4);
  Points f = Points::Zero(112, 3), mean = f;
  body.add_dashpot_force(x, v, f);
  CHECK_NEAR(body.dashpot_power(x, v) / -(f * v).sum(), 1, 1e-12);
  // by the mean rate of strain on the straight way from x to x + 0.3 v, which the strains at both ends give
  body.add_dashpot_force(x, v, mean, 0.3);
  Points back = Points::Zero(112, 3);
  body.add_dashpot_force(x, v, back, -0.3);
  CHECK(distance(mean + back, 2 * f) < 1e-12 * f.abs().maxCoeff());
  CHECK(distance(mean, f) > 1e-3 * f.abs().maxCoeff());
}

TEST(stress_at_a_place_is_that_of_the_law_and_the_stretch_is_the_largest) {
  const double ratio = 0.4, mu = 1 / (2 * (1 + ratio)), lambda = ratio / ((1 + ratio) * (1 - 2 * ratio));
  const auto body = solid_body(long_box, ratio);
  const Solid& solid = static_cast<const Solid&>(*body.energies.front());
  const Points x = homogeneous(long_box, 1.2, 0.9, 0.3);
  Mat3 f = Vec3(1.2, 0.9, 0.9).asDiagonal();
  f(0, 2) = 0.3;
  const double volume = f.determinant();
  const Mat3 wanted = mu / volume * f * f.transpose() + (mu * (volume - 2) + lambda * (volume - 1)) * Mat3::Identity();
  for (const Vec3& at : {Vec3(0, 0, 0), Vec3(0.3, 0.2, 1), Vec3(1, 0.35, 0.5), Vec3(2, 0.7, 1.1)}) {
    const MaterialState found = solid.at(SolidPlace(long_box, at), x);
    CHECK((found.gradient - f).norm() < 1e-13);
    CHECK((found.stress - wanted).norm() < 1e-13);
    CHECK_NEAR(found.largest_stretch(), std::sqrt(dense::eigenvalues(f.transpose() * f).maxCoeff()), 1e-13);
  }
  // a bent body: of the slope of places, and pressure by the projection, as the force has it at the nodes
  const Points bent = scattered(long_box, 0.02);
  const Vec3 at(1.3, 0.2, 0.4), step(1e-6, 0, 0);
  const auto place = [&](const Vec3& where) {
    const Embedding here = embed(Basis::patches, long_box, where);
    return Vec3(here(bent.col(0)), here(bent.col(1)), here(bent.col(2)));
  };
  const Vec3 slope = (place(at + step) - place(at - step)) / 2e-6;
  CHECK((solid.at(SolidPlace(long_box, at), bent).gradient.col(0) - slope).norm() < 1e-8);
  Points inverted = rest_positions(long_box);
  inverted.col(0) *= -1;
  CHECK(std::isnan(solid.at(SolidPlace(long_box, at), inverted).von_mises()));
}
