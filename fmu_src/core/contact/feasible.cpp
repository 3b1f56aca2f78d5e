#include "contact/feasible.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>

#include "contact/tolerances.hpp"

namespace softffd {

namespace {

/// Largest number of Gauss-Seidel sweeps over the planes of one point. Normal impulses and friction converge within some ten sweeps; flat
/// wedges take longer.
constexpr int most_sweeps = 200;
/// Sweeps of `push_out`: the correction for one plane may leave the point behind other planes by rounding.
constexpr int push_out_sweeps = 3;

/// Computes the multipliers of the set `chosen`, taken as equations. False if the normals are dependent or a multiplier is negative.
template <int N>
bool multipliers(const std::vector<Constraint>& constraints, const std::array<int, N>& chosen, const Vec3& target,
                 Eigen::Matrix<double, N, 1>& lambda) {
  Eigen::Matrix<double, N, 3> normals;
  Eigen::Matrix<double, N, 1> lack;
  for (int i = 0; i < N; ++i) {
    const Constraint& c = constraints[chosen[i]];
    normals.row(i) = c.normal.transpose();
    lack[i] = c.bound - c.normal.dot(target);
  }
  const Eigen::Matrix<double, N, N> gram = normals * normals.transpose();
  if (gram.determinant() < dependent) return false;
  lambda = gram.inverse() * lack;
  return (lambda.array() >= 0).all();
}

template <int N>
bool try_set(std::vector<Constraint>& constraints, const std::vector<int>& trial, const std::array<int, N>& chosen, double slack,
             const Vec3& target, Vec3& v) {
  Eigen::Matrix<double, N, 1> lambda;
  if (!multipliers<N>(constraints, chosen, target, lambda)) return false;
  Vec3 candidate = target;
  for (int i = 0; i < N; ++i) candidate += lambda[i] * constraints[chosen[i]].normal;
  for (int q : trial)
    if (constraints[q].normal.dot(candidate) < constraints[q].bound - slack) return false;
  v = candidate;
  for (int i = 0; i < N; ++i) constraints[chosen[i]].normal_impulse = lambda[i];
  return true;
}

/// Does one sweep over all planes; returns the largest change of an impulse.
double sweep(std::vector<Constraint>& constraints, Vec3& v) {
  double change = 0;
  for (Constraint& c : constraints) {
    const double normal_impulse = std::max(0.0, c.normal_impulse + c.bound - c.normal.dot(v));
    v += (normal_impulse - c.normal_impulse) * c.normal;
    change = std::max(change, std::abs(normal_impulse - c.normal_impulse));
    c.normal_impulse = normal_impulse;
    Vec3 friction_impulse = c.friction_impulse - tangential(c.normal, v - c.surface);
    const double size = friction_impulse.norm(), limit = c.friction * normal_impulse;
    if (size > limit) friction_impulse *= limit / size;
    v += friction_impulse - c.friction_impulse;
    change = std::max(change, (friction_impulse - c.friction_impulse).norm());
    c.friction_impulse = friction_impulse;
  }
  return change;
}

}  // namespace

void push_out(const std::vector<HalfSpace>& planes, Vec3& x) {
  for (int sweep = 0; sweep < push_out_sweeps; ++sweep)
    for (const HalfSpace& plane : planes)
      if (const double gap = plane.gap(x); gap < 0) x -= gap * plane.normal;
}

bool FeasibleSet::solve_trial(std::vector<Constraint>& constraints, double slack, const Vec3& target, Vec3& v) {
  const auto& t = trial_;
  for (std::size_t a = 0; a < t.size(); ++a)
    if (try_set<1>(constraints, t, {t[a]}, slack, target, v)) return true;
  for (std::size_t a = 0; a < t.size(); ++a)
    for (std::size_t b = a + 1; b < t.size(); ++b)
      if (try_set<2>(constraints, t, {t[a], t[b]}, slack, target, v)) return true;
  for (std::size_t a = 0; a < t.size(); ++a)
    for (std::size_t b = a + 1; b < t.size(); ++b)
      for (std::size_t c = b + 1; c < t.size(); ++c)
        if (try_set<3>(constraints, t, {t[a], t[b], t[c]}, slack, target, v)) return true;
  return false;
}

bool FeasibleSet::project(std::vector<Constraint>& constraints, double slack, Vec3& v) {
  const Vec3 target = v;
  trial_.clear();
  for (Constraint& c : constraints) c.normal_impulse = 0;
  for (;;) {
    int worst = -1;
    double most = slack;
    for (std::size_t q = 0; q < constraints.size(); ++q) {
      const double violation = constraints[q].bound - constraints[q].normal.dot(v);
      const bool tried = std::find(trial_.begin(), trial_.end(), int(q)) != trial_.end();
      if (violation > most && !tried) most = violation, worst = int(q);
    }
    if (worst < 0) return true;
    trial_.push_back(worst);
    for (Constraint& c : constraints) c.normal_impulse = 0;
    if (!solve_trial(constraints, slack, target, v)) return false;
  }
}

bool FeasibleSet::resolve(std::vector<Constraint>& constraints, double slack, Vec3& v) {
  bool rough = false;
  for (Constraint& c : constraints) {
    c.normal_impulse = 0;
    c.friction_impulse.setZero();
    rough = rough || c.friction > 0;
  }
  if (rough) {
    Vec3 trial = v;
    for (int i = 0; i < most_sweeps && sweep(constraints, trial) > slack; ++i) {
    }
    for (const Constraint& c : constraints) v += c.friction_impulse;
  }
  return project(constraints, slack, v);
}

}  // namespace softffd
