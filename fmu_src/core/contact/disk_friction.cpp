#include "contact/disk_friction.hpp"

#include <algorithm>
#include <cmath>

#include "contact/elimination.hpp"
#include "model/plane.hpp"

namespace softffd {

namespace {

/// Share of the largest slip that may be left.
constexpr double exact = 1e-13;
/// By how much a sweep must lower what is left for another one to follow at once.
constexpr double falling = 4;
/// Newton's steps at a time; then so many sweeps, doubled each round. On planes of different directions, where turns follow, one round,
/// and so many steps without gain.
constexpr int most_newton = 12, first_sweeps = 4, most_sweeps = 128, most_rounds = 12, most_vain = 3;

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

/// By how much a sliding row's friction turns with its aim.
Eigen::Matrix2d turning(const Eigen::Vector2d& aim, double limit) {
  const double size = aim.norm();
  const Eigen::Vector2d along = aim / size;
  return limit / size * (Eigen::Matrix2d::Identity() - along * along.transpose());
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
  stuck_known_ = disks.parallel && free_.size() == p.size();
  if (free_.empty() || (stuck_known_ && stick(disks, p))) return 0;
  double best = look(disks, p);
  best_ = p;
  const auto keep = [&] {
    const double now = look(disks, p);
    if (!(now < best)) return false;
    best = now;
    best_ = p;
    return true;
  };
  const auto sliding = [&] { return std::count_if(free_.begin(), free_.end(), [&](int t) { return slides(disks, p, t); }); };
  if (2 * sliding() > Count(free_.size()))  // fast, perhaps: then friction hardly turns, and sweeps are all it takes
    for (double before = 2 * falling * best; best > exact * largest && falling * best < before;) {
      before = best;
      sweep(disks, p);
      keep();
    }
  p = best_;
  look(disks, p);
  const int rounds = disks.parallel ? most_rounds : 1;
  for (int round = 0, sweeps = first_sweeps; round < rounds && best > exact * largest;
       ++round, sweeps = std::min(2 * sweeps, most_sweeps)) {
    for (int i = 0, vain = 0; i < most_newton && best > exact * largest && newton_step(disks, p); ++i) {
      vain = keep() ? 0 : vain + 1;
      if (!disks.parallel && vain == most_vain) break;
    }
    if (best <= exact * largest) break;
    p = best_;
    for (int i = 0; i < sweeps; ++i) sweep(disks, p);
    keep();
  }
  p = best_;
  for (const int t : free_) p[t] = into_disk(p[t], disks.limit[t]);
  return best / largest;
}

/// Of plates that face each other.
double DiskFriction::sign(const Disks& disks, int t) const {
  return disks.rows.cosine(disks.rows.rows()[0].plane, disks.rows.rows()[t].plane) < 0 ? -1 : 1;
}

/// Does everything stick? p becomes the friction that makes it, if that is within the disks.
bool DiskFriction::stick(const Disks& disks, std::vector<Vec3>& p) {
  const int n = int(p.size());
  const Tangents basis = tangents(disks.normals[disks.rows.rows()[0].plane]);
  stuck_.assign(n, Vec3::Zero());
  one_.resize(n);
  for (int a = 0; a < 2; ++a) {
    for (int t = 0; t < n; ++t) one_[t] = -sign(disks, t) * basis.col(a).dot(disks.slip[t]);
    disks.rows.solve(one_.data());
    for (int t = 0; t < n; ++t) stuck_[t] += sign(disks, t) * one_[t] * basis.col(a);
  }
  for (int t = 0; t < n; ++t)
    if (!(stuck_[t].squaredNorm() <= disks.limit[t] * disks.limit[t])) return false;
  p = stuck_;
  return true;
}

Vec3 DiskFriction::slip_at(const Disks& disks, const std::vector<Vec3>& p, int t) const {
  Vec3 moved = Vec3::Zero();
  for (const int u : free_) moved += disks.rows(t, u) * p[u];
  return disks.slip[t] + tangential(disks.normals[disks.rows.rows()[t].plane], moved);
}

/// By how much the law is missed at p, in slip.
double DiskFriction::look(const Disks& disks, const std::vector<Vec3>& p) {
  double worst = 0;
  slips_.resize(p.size());
  for (const int t : free_) {
    const double own = disks.rows(t, t);
    slips_[t] = slip_at(disks, p, t);
    worst = std::max(worst, own * (p[t] - into_disk(p[t] - slips_[t] / own, disks.limit[t])).norm());
  }
  return worst;
}

void DiskFriction::sweep(const Disks& disks, std::vector<Vec3>& p) {
  for (const int t : free_) p[t] = into_disk(p[t] - slip_at(disks, p, t) / disks.rows(t, t), disks.limit[t]);
}

bool DiskFriction::slides(const Disks& disks, const std::vector<Vec3>& p, int t) const {
  return (p[t] - slips_[t] / disks.rows(t, t)).norm() > disks.limit[t];
}

/// From p that was looked at: rows that stick have no slip, rows that slide, with their aim z and T = dp/dz, (1 - T) p + T slip(p) / G_tt =
/// limit z/|z|.
bool DiskFriction::newton_step(const Disks& disks, std::vector<Vec3>& p) {
  sliding_.clear();
  for (const int t : free_)
    if (slides(disks, p, t)) sliding_.push_back(t);
  if (stuck_known_ && 2 * sliding_.size() <= p.size()) return newton_step_of_few(disks, p);
  const int n = int(free_.size());
  slopes_.assign(4 * n * n, 0.0);
  right_.assign(2 * n, 0.0);
  const auto basis = [&](int t) { return tangents(disks.normals[disks.rows.rows()[t].plane]); };
  for (int i = 0; i < n; ++i) {
    const int t = free_[i];
    const double own = disks.rows(t, t);
    const Tangents here = basis(t);
    const Eigen::Vector2d aim = here.transpose() * (p[t] - slips_[t] / own), slip = here.transpose() * disks.slip[t];
    const bool sticks = !std::binary_search(sliding_.begin(), sliding_.end(), t);
    const Eigen::Matrix2d turn = sticks ? Eigen::Matrix2d(Eigen::Matrix2d::Identity()) : turning(aim, disks.limit[t]);
    Eigen::Vector2d wanted = -turn * slip / own;
    if (!sticks) wanted += aim * (disks.limit[t] / aim.norm());
    for (int a = 0; a < 2; ++a) right_[2 * i + a] = wanted[a];
    for (int j = 0; j < n; ++j) {
      const int u = free_[j];
      Eigen::Matrix2d block = disks.rows(t, u) / own * turn;
      if (!disks.parallel) block = block * (here.transpose() * basis(u));
      if (i == j) block += Eigen::Matrix2d::Identity() - turn;
      for (int a = 0; a < 2; ++a)
        for (int b = 0; b < 2; ++b) slopes_[(2 * i + a) * 2 * n + 2 * j + b] = block(a, b);
    }
  }
  if (!eliminate(2 * n, slopes_, right_)) return false;
  for (int i = 0; i < n; ++i) p[free_[i]] = basis(free_[i]) * Eigen::Vector2d(right_[2 * i], right_[2 * i + 1]);
  return true;
}

/// The same where few rows slide, in their slips: p = stuck + G^-1 slips.
bool DiskFriction::newton_step_of_few(const Disks& disks, std::vector<Vec3>& p) {
  const int n = int(p.size()), k = int(sliding_.size());
  const Tangents basis = tangents(disks.normals[disks.rows.rows()[0].plane]);
  columns_.assign(std::size_t(k) * n, 0.0);
  for (int j = 0; j < k; ++j) {
    double* column = &columns_[std::size_t(j) * n];
    column[sliding_[j]] = sign(disks, sliding_[j]);
    disks.rows.solve(column);
    for (int t = 0; t < n; ++t) column[t] *= sign(disks, t);
  }
  slopes_.assign(4 * k * k, 0.0);
  right_.assign(2 * k, 0.0);
  for (int i = 0; i < k; ++i) {
    const int t = sliding_[i];
    const double own = disks.rows(t, t);
    const Eigen::Vector2d aim = basis.transpose() * (p[t] - slips_[t] / own), stuck = basis.transpose() * stuck_[t];
    const Eigen::Matrix2d turn = turning(aim, disks.limit[t]), rest = Eigen::Matrix2d::Identity() - turn;
    const Eigen::Vector2d wanted = aim * (disks.limit[t] / aim.norm()) - rest * stuck;
    for (int a = 0; a < 2; ++a) {
      right_[2 * i + a] = wanted[a];
      for (int j = 0; j < k; ++j)
        for (int b = 0; b < 2; ++b)
          slopes_[(2 * i + a) * 2 * k + 2 * j + b] = rest(a, b) * columns_[std::size_t(j) * n + t] + (i == j ? turn(a, b) / own : 0.0);
    }
  }
  if (!eliminate(2 * k, slopes_, right_)) return false;
  p = stuck_;
  for (int j = 0; j < k; ++j) {
    const Vec3 slip = basis * Eigen::Vector2d(right_[2 * j], right_[2 * j + 1]);
    for (int t = 0; t < n; ++t) p[t] += columns_[std::size_t(j) * n + t] * slip;
  }
  return true;
}

}  // namespace softffd
