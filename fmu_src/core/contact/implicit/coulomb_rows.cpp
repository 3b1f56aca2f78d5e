#include "contact/implicit/coulomb_rows.hpp"

#include <algorithm>
#include <cmath>

#include "contact/elimination.hpp"
#include "model/plane.hpp"

namespace softffd {

namespace {

/// Newton's steps at a time; then so many sweeps, doubled each round.
constexpr int most_newton = 15, first_sweeps = 4, most_rounds = 8;
/// Share of a row's own compliance that keeps equations of rows that depend on each other solvable.
constexpr double regular = 1e-11;

using Mat3 = Eigen::Matrix3d;

/// Onto what the law allows.
Vec3 allowed(const Vec3& normal, double friction, const Vec3& aim) {
  const double load = std::max(0.0, normal.dot(aim));
  const Vec3 across = tangential(normal, aim);
  const double size = across.norm();
  return load * normal + (size <= friction * load ? across : Vec3(across * (friction * load / size)));
}

/// Its derivative.
Mat3 slope(const Vec3& normal, double friction, const Vec3& aim) {
  const double load = normal.dot(aim);
  if (load <= 0) return Mat3::Zero();
  const Vec3 across = tangential(normal, aim);
  const double size = across.norm();
  if (size <= friction * load) return Mat3::Identity();
  const Mat3 out = normal * normal.transpose();
  const Vec3 along = across / size;
  return out + friction * along * normal.transpose() + friction * load / size * (Mat3::Identity() - out - along * along.transpose());
}

}  // namespace

double CoulombRows::solve(const Problem& problem, std::vector<Vec3>& force) {
  const int n = int(force.size());
  own_.resize(n);
  for (int s = 0; s < n; ++s) own_[s] = problem.g[s * n + s].trace() / 3;
  start_ = force;
  double best = look(problem, force);
  best_ = force;
  const auto keep = [&] {
    const double now = look(problem, force);
    if (!(now < best)) return;
    best = now;
    best_ = force;
  };
  for (int round = 0, sweeps = first_sweeps; round < most_rounds && best > problem.exact; ++round, sweeps *= 2) {
    for (int i = 0; i < most_newton && best > problem.exact && newton_step(problem, force); ++i) keep();
    if (best <= problem.exact) break;
    force = best_;
    for (int i = 0; i < sweeps; ++i) sweep(problem, force);
    keep();
  }
  force = best_;
  return best;
}

/// Displacements at these forces. Returns by how much the law is missed.
double CoulombRows::look(const Problem& problem, const std::vector<Vec3>& force) {
  const int n = int(force.size());
  u_ = problem.u;
  double worst = 0;
  for (int s = 0; s < n; ++s) {
    for (int t = 0; t < n; ++t) u_[s] += problem.g[s * n + t] * (force[t] - start_[t]);
    worst = std::max(worst, own_[s] * (force[s] - allowed(problem.normals[s], problem.friction[s], aim(s, force[s]))).norm());
  }
  return worst;
}

/// From forces that were looked at.
bool CoulombRows::newton_step(const Problem& problem, std::vector<Vec3>& force) {
  const int n = int(force.size()), size = 3 * n;
  ++iterations_;
  slopes_.assign(std::size_t(size) * size, 0.0);
  right_.assign(size, 0.0);
  for (int s = 0; s < n; ++s) {
    const Vec3 to = aim(s, force[s]);
    const Mat3 d = slope(problem.normals[s], problem.friction[s], to);
    const Vec3 lack = allowed(problem.normals[s], problem.friction[s], to) - force[s];
    for (int t = 0; t < n; ++t) {
      Mat3 block = d * problem.g[s * n + t] / own_[s];
      if (s == t) block += (1 + regular) * Mat3::Identity() - d;
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) slopes_[std::size_t(3 * s + a) * size + 3 * t + b] = block(a, b);
    }
    for (int a = 0; a < 3; ++a) right_[3 * s + a] = lack[a];
  }
  if (!eliminate(size, slopes_, right_)) return false;
  for (int s = 0; s < n; ++s) force[s] += Vec3(right_[3 * s], right_[3 * s + 1], right_[3 * s + 2]);
  return true;
}

void CoulombRows::sweep(const Problem& problem, std::vector<Vec3>& force) {
  const int n = int(force.size());
  for (int s = 0; s < n; ++s) {
    Vec3 u = problem.u[s];
    for (int t = 0; t < n; ++t) u += problem.g[s * n + t] * (force[t] - start_[t]);
    force[s] = allowed(problem.normals[s], problem.friction[s], force[s] - u / own_[s]);
  }
}

}  // namespace softffd
