#include "contact/surface/disk_friction.hpp"

#include <algorithm>
#include <cmath>

#include "contact/elimination.hpp"
#include "model/arithmetic.hpp"
#include "model/plane.hpp"

namespace softffd {

namespace {

/// The iteration ends when the error of the friction law, as a slip, is at most this fraction of the largest slip.
constexpr double exact = 1e-13;
/// Another sweep follows at once if the last one has reduced the error by at least this factor.
constexpr double falling = 4;
/// Operations for a pair of rows in a sweep, in `look`, and in Newton's equations.
constexpr double sweep_work = 10;
/// A round has up to most_newton Newton steps, then sweeps: fewest_sweeps in the first round, twice as many in each next, up to
/// most_sweeps.
constexpr int most_newton = 12, fewest_sweeps = 4, most_sweeps = 128, most_newton_rounds = 12;

Eigen::Vector2d into_disk(const Eigen::Vector2d& p, double limit) {
  const double squared = p.squaredNorm();
  return squared <= limit * limit ? p : Eigen::Vector2d(p * (limit / std::sqrt(squared)));
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

/// Returns the derivative of a sliding row's friction with respect to its aim.
Eigen::Matrix2d turning(const Eigen::Vector2d& aim, double limit) {
  const double size = aim.norm();
  const Eigen::Vector2d along = aim / size;
  return limit / size * (Eigen::Matrix2d::Identity() - along * along.transpose());
}

}  // namespace

double DiskFriction::solve(const Disks& disks, std::vector<Vec3>& p) {
  count_ = int(p.size());
  if (count_ == 0) return 0;
  const TangentBasis basis = tangents(disks.normals[disks.rows.rows()[0].plane]);
  p_.resize(count_);
  free_slips_.resize(count_);
  free_.clear();
  for (int t = 0; t < count_; ++t) {
    free_slips_[t] = basis.transpose() * disks.slip[t];
    p_[t] = into_disk(basis.transpose() * p[t], disks.limit[t]);
    if (disks.limit[t] > 0) free_.push_back(t);
  }
  const double missed = find_friction(disks);
  for (int t = 0; t < count_; ++t) p[t] = basis * p_[t];
  return missed;
}

double DiskFriction::find_friction(const Disks& disks) {
  double largest = 0;
  for (const Pair& slip : free_slips_) largest = std::max(largest, slip.norm());
  if (largest == 0) {
    std::fill(p_.begin(), p_.end(), Pair::Zero());
    return 0;
  }
  if (free_.empty()) return 0;
  all_free_ = int(free_.size()) == count_;
  stuck_known_ = false;
  const bool slides_on = std::ranges::any_of(free_, [&](int t) { return p_[t].norm() >= slid * disks.limit[t]; });
  if (all_free_ && !slides_on && stick(disks)) return 0;
  spread(disks.rows);
  double best = look(disks);
  best_ = p_;
  bool at_best = true;
  const auto keep = [&] {
    const double now = look(disks);
    at_best = now < best;
    if (!at_best) return;
    best = now;
    best_ = p_;
  };
  const auto back_to_best = [&] {
    if (at_best) return;
    p_ = best_;
    look(disks);
  };
  const auto left = [&] { return best > exact * largest && !disks.rows.operations().spent(); };
  if (2 * sliding_.size() > free_.size())  // perhaps sliding is fast: friction hardly turns then, and sweeps suffice
    for (double before = 2 * falling * best; left() && falling * best < before;) {
      before = best;
      sweep(disks);
      keep();
    }
  back_to_best();
  for (int round = 0, sweeps = fewest_sweeps; round < most_newton_rounds && left(); ++round, sweeps = std::min(2 * sweeps, most_sweeps)) {
    for (int i = 0; i < most_newton && left() && newton_step(disks); ++i) keep();
    if (!left()) break;
    at_best = false;
    back_to_best();
    for (int i = 0; i < sweeps; ++i) sweep(disks);
    keep();
  }
  p_ = best_;
  for (const int t : free_) p_[t] = into_disk(p_[t], disks.limit[t]);
  return best / largest;
}

/// Returns -1 if the plane of row t faces the plane of the first row, as plates that face each other do; else 1.
double DiskFriction::sign(const Disks& disks, int t) const {
  return disks.rows.cosine(disks.rows.rows()[0].plane, disks.rows.rows()[t].plane) < 0 ? -1 : 1;
}

/// Copies G, row by row.
void DiskFriction::spread(const Delassus& rows) {
  known_.assign(count_, 0);
  columns_.resize(count_ * count_);
  g_.resize(count_ * count_);
  inverse_own_.resize(count_);
  for (int t = 0; t < count_; ++t) {
    for (int u = 0; u <= t; ++u) g_[t * count_ + u] = g_[u * count_ + t] = rows(t, u);
    inverse_own_[t] = 1 / rows(t, t);
  }
}

/// Computes the friction with which everything sticks.
void DiskFriction::find_stuck(const Disks& disks) {
  constexpr int together = Delassus::together;  // two columns are used
  if (stuck_known_) return;
  stuck_known_ = true;
  stuck_.resize(count_);
  columns_at_once_.assign(together * count_, 0.0);
  for (int t = 0; t < count_; ++t)
    for (int a = 0; a < 2; ++a) columns_at_once_[together * t + a] = -sign(disks, t) * free_slips_[t][a];
  disks.rows.solve_together(columns_at_once_.data());
  for (int t = 0; t < count_; ++t) stuck_[t] = sign(disks, t) * Pair(columns_at_once_[together * t], columns_at_once_[together * t + 1]);
}

/// True if everything sticks, that is, if the friction for this lies within the disks. Then p becomes that friction.
bool DiskFriction::stick(const Disks& disks) {
  find_stuck(disks);
  for (int t = 0; t < count_; ++t)
    if (!(stuck_[t].squaredNorm() <= disks.limit[t] * disks.limit[t])) return false;
  p_ = stuck_;
  return true;
}

void DiskFriction::find_slips() {
  slips_ = free_slips_;
  for (const int u : free_) {
    const double* g = &g_[u * count_];
    for (int t = 0; t < count_; ++t) slips_[t] += g[t] * p_[u];
  }
}

/// Returns by how much the friction law is violated at p, as a slip, and finds the rows that slide at p.
double DiskFriction::look(const Disks& disks) {
  disks.rows.operations().spend(sweep_work * double(free_.size()) * double(free_.size()));
  find_slips();
  sliding_.clear();
  double worst = 0;  // squared
  for (const int t : free_) {
    const Pair to = aim(t);
    const double squared = to.squaredNorm(), limit = disks.limit[t];
    if (squared > limit * limit) {
      sliding_.push_back(t);
      worst = std::max(worst, (p_[t] - limit / std::sqrt(squared) * to).squaredNorm() / power(inverse_own_[t], 2));
    } else {
      worst = std::max(worst, slips_[t].squaredNorm());
    }
  }
  return std::sqrt(worst);
}

/// Sweeps once over the disks from known slips. The sweep updates the slips; `look` sums them anew, so that rounding does not add up.
void DiskFriction::sweep(const Disks& disks) {
  disks.rows.operations().spend(sweep_work * double(free_.size()) * double(free_.size()));
  for (const int t : free_) {
    const Pair to = into_disk(aim(t), disks.limit[t]), more = to - p_[t];
    p_[t] = to;
    const double* g = &g_[t * count_];
    for (int u = 0; u < count_; ++u) slips_[u] += g[u] * more;
  }
}

/// Takes a Newton step from a p that `look` has evaluated. The aim of a row is z = p - slip(p) / G_tt. A row that sticks has no slip. A
/// row that slides has the friction limit z/|z|, which turns with the aim by T = limit / |z| (1 - z z'/z.z). Along z its friction is
/// therefore known; across z it is p = T (p - slip(p) / G_tt).
bool DiskFriction::newton_step(const Disks& disks) {
  if (all_free_ && 3 * int(sliding_.size()) <= 2 * count_) return newton_step_of_few(disks);
  unknowns_.clear();
  auto slides_too = sliding_.begin();
  for (const int t : free_) {
    if (slides_too != sliding_.end() && *slides_too == t) {
      ++slides_too;
      const Pair to = aim(t);
      const double size = to.norm();
      p_[t] = disks.limit[t] / size * to;
      unknowns_.push_back({t, Pair(-to[1], to[0]) / size, disks.limit[t] / size});
    } else {
      p_[t].setZero();
      for (int a = 0; a < 2; ++a) unknowns_.push_back({t, Pair::Unit(a), 1});
    }
  }
  const int n = int(unknowns_.size());
  disks.rows.operations().spend(double(n) * n * (n / 3.0 + sweep_work));
  if (disks.rows.operations().spent()) return false;
  slopes_.resize(std::size_t(n) * n);
  right_.resize(n);
  find_slips();
  for (int i = 0; i < n; ++i) {
    const auto& [t, along, turn] = unknowns_[i];
    const double fraction = turn * inverse_own_[t], *row = &g_[t * count_];
    right_[i] = -fraction * along.dot(slips_[t]);
    for (int j = 0; j < n; ++j) slopes_[i * n + j] = fraction * row[unknowns_[j].row] * along.dot(unknowns_[j].along);
    slopes_[i * n + i] += 1 - turn;
  }
  if (!eliminate(n, slopes_, right_)) return false;
  for (int i = 0; i < n; ++i) p_[unknowns_[i].row] += right_[i] * unknowns_[i].along;
  return true;
}

/// Computes the columns of G^-1 of the rows that slide, with the signs of their planes, four at a time. Known columns are kept.
void DiskFriction::find_columns(const Disks& disks) {
  constexpr int together = Delassus::together;
  int wanted[together], found = 0;
  const auto solve = [&] {
    columns_at_once_.assign(together * count_, 0.0);
    for (int c = 0; c < found; ++c) columns_at_once_[together * wanted[c] + c] = sign(disks, wanted[c]);
    disks.rows.solve_together(columns_at_once_.data());
    for (int c = 0; c < found; ++c) {
      for (int t = 0; t < count_; ++t) columns_[wanted[c] * count_ + t] = sign(disks, t) * columns_at_once_[together * t + c];
      known_[wanted[c]] = 1;
    }
    found = 0;
  };
  for (const int t : sliding_)
    if (!known_[t] && (wanted[found++] = t, found == together)) solve();
  if (found > 0) solve();
}

/// Takes the same step where few rows slide, with their slips as unknowns: p = stuck + G^-1 slips.
bool DiskFriction::newton_step_of_few(const Disks& disks) {
  const int k = int(sliding_.size());
  disks.rows.operations().spend(double(k) * k * (8.0 / 3 * k + count_));
  find_stuck(disks);
  find_columns(disks);
  slopes_.assign(4 * k * k, 0.0);
  right_.assign(2 * k, 0.0);
  for (int i = 0; i < k; ++i) {
    const int t = sliding_[i];
    const Pair to = aim(t);
    const Eigen::Matrix2d turn = turning(to, disks.limit[t]), rest = Eigen::Matrix2d::Identity() - turn;
    const Pair wanted = to * (disks.limit[t] / to.norm()) - rest * stuck_[t];
    for (int a = 0; a < 2; ++a) {
      right_[2 * i + a] = wanted[a];
      for (int j = 0; j < k; ++j)
        for (int b = 0; b < 2; ++b)
          slopes_[(2 * i + a) * 2 * k + 2 * j + b] = rest(a, b) * column(sliding_[j])[t] + (i == j ? turn(a, b) * inverse_own_[t] : 0.0);
    }
  }
  if (!eliminate(2 * k, slopes_, right_)) return false;
  p_ = stuck_;
  for (int j = 0; j < k; ++j) {
    const Pair slip(right_[2 * j], right_[2 * j + 1]);
    const double* moved = column(sliding_[j]);
    for (int t = 0; t < count_; ++t) p_[t] += moved[t] * slip;
  }
  return true;
}

}  // namespace softffd
