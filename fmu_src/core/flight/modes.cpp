#include "flight/modes.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "model/arithmetic.hpp"

namespace softffd {

namespace {

/// If the lowest frequency is below this fraction of the largest, it is that of a part that nothing holds.
constexpr double loose = 1e-6;
/// Unequal damping is added to the matrix with this fraction of the largest diagonal entry, so that it separates modes of the same
/// frequency: far above rounding, and far below what affects the phase of a vibration.
constexpr double sorting = 1e-11;

/// M^-1/2 K M^-1/2.
struct ScaledMatrix final : BlockSink {
  explicit ScaledMatrix(const Scalars& mass) : mass(mass), matrix(Eigen::MatrixXd::Zero(3 * mass.size(), 3 * mass.size())) {}
  void add(int p, int q, const Mat3& block) override {
    const int n = int(mass.size());
    const double scale = p == q ? mass[p] : std::sqrt(mass[p] * mass[q]);
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) {
        matrix(p + a * n, q + b * n) += block(a, b) / scale;
        if (p != q) matrix(q + b * n, p + a * n) += block(a, b) / scale;
      }
  }
  const Scalars& mass;
  Eigen::MatrixXd matrix;
};

}  // namespace

void Modes::make(const Body& body, const Points& rest) {
  const int n = body.points(), unknowns = 3 * n;
  mass = body.mass.sum();
  Vec3 centre = Vec3::Zero();
  for (int p = 0; p < n; ++p) centre += body.mass[p] / mass * row(rest, p);
  arms = rest;
  inertia.setZero();
  radius = 0;
  for (int p = 0; p < n; ++p) {
    const Vec3 arm = row(rest, p) - centre;
    set_row(arms, p, arm);
    radius = std::max(radius, arm.norm());
    inertia += body.mass[p] * (arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose());
  }
  damped_unevenly = false;
  valid_ = unknowns > most_unknowns;
  if (valid_) {
    frequency.resize(0);
    decay.resize(0);
    shape.resize(unknowns, 0);
    excursion.resize(n, 0);
    return;
  }
  ScaledMatrix by_mass(body.mass);
  for (const auto& each : body.energies) each->add_blocks(rest, {}, by_mass);
  Eigen::MatrixXd& matrix = by_mass.matrix;
  const Scalars rate = body.damping / body.mass;
  const double fastest = rate.maxCoeff();
  if (fastest > rate.minCoeff()) {
    const double factor = sorting * matrix.diagonal().maxCoeff() / fastest;
    for (int i = 0; i < unknowns; ++i) matrix(i, i) += factor * rate[i % n];
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix);
  const int modes = unknowns - 6;
  valid_ = solver.info() == Eigen::Success && modes > 0 && std::isfinite(solver.eigenvalues().sum()) &&
           solver.eigenvalues()[6] > loose * loose * solver.eigenvalues()[unknowns - 1];
  if (!valid_) return;
  frequency = solver.eigenvalues().tail(modes).array().sqrt();
  shape = solver.eigenvectors().rightCols(modes);
  for (int i = 0; i < unknowns; ++i) shape.row(i) /= std::sqrt(body.mass[i % n]);
  decay.resize(modes);
  excursion.resize(n, modes);
  for (int a = 0; a < modes; ++a) {
    decay[a] = 0;
    for (int i = 0; i < unknowns; ++i) decay[a] += 0.5 * body.damping[i % n] * shape(i, a) * shape(i, a);
    for (int p = 0; p < n; ++p) excursion(p, a) = Vec3(shape(p, a), shape(p + n, a), shape(p + 2 * n, a)).norm();
  }
  damped_unevenly = fastest > rate.minCoeff();
  if (damped_unevenly) find_uneven(body.damping);
  neighbours_.setZero(modes * most_neighbours, 3);
  for (int a = 0; a < modes; ++a)
    for (int b = a + 1; b < std::min(modes, a + 1 + most_neighbours); ++b) {
      Vec3 sum = Vec3::Zero();
      for (int p = 0; p < n; ++p) {
        const Vec3 of_a(shape(p, a), shape(p + n, a), shape(p + 2 * n, a)), of_b(shape(p, b), shape(p + n, b), shape(p + 2 * n, b));
        sum += body.mass[p] * of_b.cross(of_a);
      }
      set_row(neighbours_, a * most_neighbours + b - a - 1, sum);
    }
}

void Modes::find_uneven(const Scalars& damping) {
  const Eigen::MatrixXd coupled = shape.transpose() * damping.replicate(3, 1).matrix().asDiagonal() * shape;
  uneven.setZero(count());
  const Eigen::ArrayXd way = excursion.colwise().maxCoeff();
  for (int b = 0; b < count(); ++b)
    for (int a = 0; a < count(); ++a) {
      if (a == b || coupled(a, b) == 0) continue;
      const double apart = std::abs(power(frequency[a], 2) - power(frequency[b], 2)), fading = 1 / coupled(b, b);
      const double factor = apart * fading > frequency[b] ? frequency[b] / apart : fading;
      uneven[b] = std::max(uneven[b], std::abs(coupled(a, b)) * factor * way[a]);
    }
}

}  // namespace softffd
