#include "contact/disk_friction.hpp"

#include <Eigen/LU>
#include <algorithm>

#include "model/plane.hpp"

namespace softffd {

namespace {

/// Share of the largest slip that may be left.
constexpr double exact = 1e-13;
/// Newton's steps at a time; then so many sweeps, doubled each round.
constexpr int most_newton = 12, first_sweeps = 4, most_sweeps = 128, most_rounds = 12;

Vec3 into_disk(const Vec3& p, double limit) {
  const double size = p.norm();
  return size <= limit ? p : Vec3(p * (limit / size));
}

using Tangents = Eigen::Matrix<double, 3, 2>;

Tangents tangents(const Vec3& normal) {
  int least = 0;
  for (int a = 1; a < 3; ++a)
    if (std::abs(normal[a]) < std::abs(normal[least])) least = a;
  Tangents t;
  t.col(0) = normal.cross(Vec3::Unit(least)).normalized();
  t.col(1) = normal.cross(t.col(0));
  return t;
}

}  // namespace

double DiskFriction::solve(const Disks& disks, std::vector<Vec3>& p) {
  double largest = 0;
  for (const Vec3& slip : disks.slip) largest = std::max(largest, slip.norm());
  if (largest == 0) {
    std::fill(p.begin(), p.end(), Vec3::Zero());
    return 0;
  }
  free_.clear();
  for (int t = 0; t < int(p.size()); ++t) {
    p[t] = into_disk(tangential(disks.normals[disks.rows.rows()[t].plane], p[t]), disks.limit[t]);
    if (disks.limit[t] > 0) free_.push_back(t);
  }
  if (free_.empty() || (disks.parallel && free_.size() == p.size() && stick(disks, p))) return 0;
  double best = residual(disks, p);
  best_ = p;
  const auto keep = [&] {
    const double now = residual(disks, p);
    if (now < best) best = now, best_ = p;
  };
  for (int round = 0, sweeps = first_sweeps; round < most_rounds && best > exact * largest;
       ++round, sweeps = std::min(2 * sweeps, most_sweeps)) {
    for (int i = 0; i < most_newton && best > exact * largest && newton_step(disks, p); ++i) keep();
    if (best <= exact * largest) break;
    p = best_;
    for (int i = 0; i < sweeps; ++i) sweep(disks, p);
    keep();
  }
  p = best_;
  for (const int t : free_) p[t] = into_disk(p[t], disks.limit[t]);
  return best / largest;
}

/// Does everything stick? p becomes the friction that makes it, if that is within the disks.
bool DiskFriction::stick(const Disks& disks, std::vector<Vec3>& p) {
  const int n = int(p.size());
  const auto sign = [&](int t) { return disks.rows.cosine(disks.rows.rows()[0].plane, disks.rows.rows()[t].plane) < 0 ? -1.0 : 1.0; };
  best_.resize(n);
  one_.resize(n);
  for (int a = 0; a < 3; ++a) {
    for (int t = 0; t < n; ++t) one_[t] = -sign(t) * disks.slip[t][a];
    disks.rows.solve(one_.data());
    for (int t = 0; t < n; ++t) best_[t][a] = sign(t) * one_[t];
  }
  for (int t = 0; t < n; ++t)
    if (!(best_[t].squaredNorm() <= disks.limit[t] * disks.limit[t])) return false;
  p = best_;
  return true;
}

Vec3 DiskFriction::slip_at(const Disks& disks, const std::vector<Vec3>& p, int t) const {
  Vec3 moved = Vec3::Zero();
  for (const int u : free_) moved += disks.rows(t, u) * p[u];
  return disks.slip[t] + tangential(disks.normals[disks.rows.rows()[t].plane], moved);
}

/// In slip.
double DiskFriction::residual(const Disks& disks, const std::vector<Vec3>& p) {
  double worst = 0;
  for (const int t : free_) {
    const double own = disks.rows(t, t);
    worst = std::max(worst, own * (p[t] - into_disk(p[t] - slip_at(disks, p, t) / own, disks.limit[t])).norm());
  }
  return worst;
}

void DiskFriction::sweep(const Disks& disks, std::vector<Vec3>& p) {
  for (const int t : free_) p[t] = into_disk(p[t] - slip_at(disks, p, t) / disks.rows(t, t), disks.limit[t]);
}

bool DiskFriction::newton_step(const Disks& disks, std::vector<Vec3>& p) {
  const int n = int(free_.size());
  Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  Eigen::VectorXd wanted(2 * n);
  std::vector<Tangents> bases;
  for (const Vec3& normal : disks.normals) bases.push_back(tangents(normal));
  const auto basis = [&](int t) -> const Tangents& { return bases[disks.rows.rows()[t].plane]; };
  for (int i = 0; i < n; ++i) {
    const int t = free_[i];
    const double own = disks.rows(t, t);
    const Eigen::Vector2d slip = basis(t).transpose() * slip_at(disks, p, t), here = basis(t).transpose() * p[t], aim = here - slip / own;
    const double size = aim.norm(), limit = disks.limit[t];
    const bool sticks = size <= limit;
    const Eigen::Vector2d along = sticks ? Eigen::Vector2d(0, 0) : Eigen::Vector2d(aim / size);
    const Eigen::Matrix2d turn = sticks ? Eigen::Matrix2d(Eigen::Matrix2d::Identity())
                                        : Eigen::Matrix2d(limit / size * (Eigen::Matrix2d::Identity() - along * along.transpose()));
    wanted.segment<2>(2 * i) = (sticks ? aim : Eigen::Vector2d(limit * along)) - here;
    for (int j = 0; j < n; ++j) {
      const int u = free_[j];
      Eigen::Matrix2d block = disks.rows(t, u) / own * turn;
      if (!disks.parallel) block = block * (basis(t).transpose() * basis(u));
      slopes.block<2, 2>(2 * i, 2 * j) = block;
    }
    slopes.block<2, 2>(2 * i, 2 * i) += Eigen::Matrix2d::Identity() - turn;
  }
  const Eigen::VectorXd change = slopes.partialPivLu().solve(wanted);
  if (!(change.array() - change.array() == 0).all()) return false;
  for (int i = 0; i < n; ++i) p[free_[i]] += basis(free_[i]) * change.segment<2>(2 * i);
  return true;
}

}  // namespace softffd
