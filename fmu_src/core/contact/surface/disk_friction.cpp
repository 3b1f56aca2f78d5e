#include "contact/surface/disk_friction.hpp"

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
/// Operations of a pair of rows in a sweep, in a look, and in Newton's equations.
constexpr double sweep_work = 10;
/// Newton's steps at a time; then so many sweeps, doubled each round.
constexpr int most_newton = 12, fewest_sweeps = 4, most_sweeps = 128, most_newton_rounds = 12;

Vec3 into_disk(const Vec3& p, double limit) {
  const double size = p.norm();
  return size <= limit ? p : Vec3(p * (limit / size));
}

using TangentBasis = Eigen::Matrix<double, 3, 2>;

TangentBasis tangents(const Vec3& normal) {
  int least = 0;
  for (int a = 1; a < 3; ++a)
    if (std::abs(normal[a]) < std::abs(normal[least])) least = a;
  TangentBasis t;
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
  stuck_known_ = free_.size() == p.size();
  if (free_.empty() || (stuck_known_ && stick(disks, p))) return 0;
  spread(disks.rows);
  double best = look(disks, p);
  best_ = p;
  const auto keep = [&] {
    const double now = look(disks, p);
    if (!(now < best)) return;
    best = now;
    best_ = p;
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
  const Operations& done = disks.rows.operations();
  for (int round = 0, sweeps = fewest_sweeps; round < most_newton_rounds && best > exact * largest && !done.spent();
       ++round, sweeps = std::min(2 * sweeps, most_sweeps)) {
    for (int i = 0; i < most_newton && best > exact * largest && !done.spent() && newton_step(disks, p); ++i) keep();
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

/// G, row by row.
void DiskFriction::spread(const Delassus& rows) {
  count_ = rows.size();
  known_.assign(count_, 0);
  columns_.resize(count_ * count_);
  g_.resize(count_ * count_);
  for (int t = 0; t < count_; ++t)
    for (int u = 0; u <= t; ++u) g_[t * count_ + u] = g_[u * count_ + t] = rows(t, u);
}

/// Does everything stick? p becomes the friction that makes it, if that is within the disks.
bool DiskFriction::stick(const Disks& disks, std::vector<Vec3>& p) {
  const int n = int(p.size());
  const TangentBasis basis = tangents(disks.normals[disks.rows.rows()[0].plane]);
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
  const double* row = &g_[t * count_];
  for (const int u : free_) moved += row[u] * p[u];
  return disks.slip[t] + tangential(disks.normals[disks.rows.rows()[t].plane], moved);
}

/// By how much the law is missed at p, in slip.
double DiskFriction::look(const Disks& disks, const std::vector<Vec3>& p) {
  disks.rows.operations().spend(sweep_work * double(free_.size()) * double(free_.size()));
  double worst = 0;
  slips_.resize(p.size());
  for (const int t : free_) {
    slips_[t] = slip_at(disks, p, t);
    worst = std::max(worst, own(t) * (p[t] - into_disk(p[t] - slips_[t] / own(t), disks.limit[t])).norm());
  }
  return worst;
}

void DiskFriction::sweep(const Disks& disks, std::vector<Vec3>& p) {
  disks.rows.operations().spend(sweep_work * double(free_.size()) * double(free_.size()));
  for (const int t : free_) p[t] = into_disk(p[t] - slip_at(disks, p, t) / own(t), disks.limit[t]);
}

bool DiskFriction::slides(const Disks& disks, const std::vector<Vec3>& p, int t) const {
  return (p[t] - slips_[t] / own(t)).norm() > disks.limit[t];
}

/// From p that was looked at. With a row's aim z = p - slip(p) / G_tt: one that sticks has no slip; one that slides has limit z/|z|, which
/// turns with its aim by T = limit / |z| (1 - z z'/z.z), so that along z its friction is known, and across p = T (p - slip(p) / G_tt).
bool DiskFriction::newton_step(const Disks& disks, std::vector<Vec3>& p) {
  sliding_.clear();
  for (const int t : free_)
    if (slides(disks, p, t)) sliding_.push_back(t);
  if (stuck_known_ && 3 * sliding_.size() <= 2 * p.size()) return newton_step_of_few(disks, p);
  unknowns_.clear();
  auto slides_too = sliding_.begin();
  for (const int t : free_) {
    const Vec3& normal = disks.normals[disks.rows.rows()[t].plane];
    if (slides_too != sliding_.end() && *slides_too == t) {
      ++slides_too;
      const Vec3 aim = p[t] - slips_[t] / own(t);
      const double size = aim.norm();
      p[t] = disks.limit[t] / size * aim;
      unknowns_.push_back({t, normal.cross(aim) / size, disks.limit[t] / size});
    } else {
      const TangentBasis basis = tangents(normal);
      p[t].setZero();
      for (int a = 0; a < 2; ++a) unknowns_.push_back({t, basis.col(a), 1});
    }
  }
  const int n = int(unknowns_.size());
  disks.rows.operations().spend(double(n) * n * (n / 3.0 + sweep_work));
  if (disks.rows.operations().spent()) return false;
  slopes_.resize(std::size_t(n) * n);
  right_.resize(n);
  for (int i = 0; i < n; ++i) {
    const auto& [t, along, turn] = unknowns_[i];
    const double share = turn / own(t), *row = &g_[t * count_];
    right_[i] = -share * along.dot(slip_at(disks, p, t));
    for (int j = 0; j < n; ++j) slopes_[i * n + j] = share * row[unknowns_[j].row] * along.dot(unknowns_[j].along);
    slopes_[i * n + i] += 1 - turn;
  }
  if (!eliminate(n, slopes_, right_)) return false;
  for (int i = 0; i < n; ++i) p[unknowns_[i].row] += right_[i] * unknowns_[i].along;
  return true;
}

/// Columns of G^-1 of the rows that slide, with the signs of their planes, four at a time; those that are known stay.
void DiskFriction::find_columns(const Disks& disks) {
  constexpr int together = Delassus::together;
  int wanted[together], found = 0;
  const auto solve = [&] {
    one_.assign(together * count_, 0.0);
    for (int c = 0; c < found; ++c) one_[together * wanted[c] + c] = sign(disks, wanted[c]);
    disks.rows.solve_together(one_.data());
    for (int c = 0; c < found; ++c) {
      for (int t = 0; t < count_; ++t) columns_[wanted[c] * count_ + t] = sign(disks, t) * one_[together * t + c];
      known_[wanted[c]] = 1;
    }
    found = 0;
  };
  for (const int t : sliding_)
    if (!known_[t] && (wanted[found++] = t, found == together)) solve();
  if (found > 0) solve();
}

/// The same where few rows slide, in their slips: p = stuck + G^-1 slips.
bool DiskFriction::newton_step_of_few(const Disks& disks, std::vector<Vec3>& p) {
  const int n = int(p.size()), k = int(sliding_.size());
  disks.rows.operations().spend(double(k) * k * (8.0 / 3 * k + n));
  const TangentBasis basis = tangents(disks.normals[disks.rows.rows()[0].plane]);
  find_columns(disks);
  slopes_.assign(4 * k * k, 0.0);
  right_.assign(2 * k, 0.0);
  for (int i = 0; i < k; ++i) {
    const int t = sliding_[i];
    const Eigen::Vector2d aim = basis.transpose() * (p[t] - slips_[t] / own(t)), stuck = basis.transpose() * stuck_[t];
    const Eigen::Matrix2d turn = turning(aim, disks.limit[t]), rest = Eigen::Matrix2d::Identity() - turn;
    const Eigen::Vector2d wanted = aim * (disks.limit[t] / aim.norm()) - rest * stuck;
    for (int a = 0; a < 2; ++a) {
      right_[2 * i + a] = wanted[a];
      for (int j = 0; j < k; ++j)
        for (int b = 0; b < 2; ++b)
          slopes_[(2 * i + a) * 2 * k + 2 * j + b] = rest(a, b) * column(sliding_[j])[t] + (i == j ? turn(a, b) / own(t) : 0.0);
    }
  }
  if (!eliminate(2 * k, slopes_, right_)) return false;
  p = stuck_;
  for (int j = 0; j < k; ++j) {
    const Vec3 slip = basis * Eigen::Vector2d(right_[2 * j], right_[2 * j + 1]);
    const double* moved = column(sliding_[j]);
    for (int t = 0; t < n; ++t) p[t] += moved[t] * slip;
  }
  return true;
}

}  // namespace softffd
