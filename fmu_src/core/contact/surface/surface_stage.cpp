#include "contact/surface/surface_stage.hpp"

#include <algorithm>

#include "contact/surface/surface_loops.hpp"
#include "model/plane.hpp"

namespace softffd {

namespace {

/// most_turns: largest number of times that all forces together and then the normal forces alone are found. balanced: all forces together
/// may leave this fraction of the largest displacement that they cancel [1].
constexpr int most_turns = 30;
constexpr double exact_balance = 1e-13;
/// Largest number of rounds in `solve_normal_forces`: in each of them a row has lost its normal force to friction.
constexpr int most_settlings = 1000;
/// A row that slid starts with an aim at this multiple of its friction limit, so that it may slide on.
constexpr double slides_on = 2;

}  // namespace

void SurfaceStage::set_planes(const std::vector<Vec3>& normals, const std::vector<double>& friction, const std::vector<int>& samples) {
  if (normals.size() != normals_.size()) set_.delassus().forget();  // the planes of the rows may no longer exist
  gaps.resize(normals.size());
  const int points = set_.delassus().samples().lattice().points();
  for (std::size_t q = 0; q < normals.size(); ++q) {
    gaps[q].sample = samples[q];
    if (gaps[q].of_points.size() == 0 && samples[q] < 0) gaps[q].of_points.setZero(points);
  }
  normals_ = normals;
  friction_ = friction;
  set_.delassus().set_normals(normals_);
}

StepStatus SurfaceStage::solve(double tolerance, const std::function<Vec3(const SurfaceRow&)>& slip) {
  begin_ = gaps;
  missed_ = 0;
  added_ = false;
  set_.delassus().set_rows(rows);
  p_.assign(rows.size(), Vec3::Zero());
  const bool has_friction = std::ranges::any_of(friction_, [](double each) { return each > 0; });
  const bool free = set_.delassus().free();
  before_ = rows;
  bool at_once = has_friction && (free || !parallel());
  if (!at_once) {
    if (const StepStatus status = solve_normal_forces(tolerance); status != StepStatus::ok) return status;
    const bool one_direction = parallel();
    if (has_friction && one_direction) solve_friction(slip);
    find_forces();
    find_move();
    at_once = has_friction && !(one_direction && stays_apart(tolerance));
  }
  if (at_once) {
    added_ = false;
    rows = before_;
    set_.delassus().set_rows(rows);
    p_.assign(rows.size(), Vec3::Zero());
    const StepStatus status = free ? solve_all_forces<Eigen::Matrix3d>(tolerance, slip) : solve_all_forces<double>(tolerance, slip);
    if (status != StepStatus::ok) return status;
    find_forces();
    find_move();
  }
  fraction.assign(rows.size(), Vec3::Zero());
  for (std::size_t t = 0; t < rows.size(); ++t)
    if (limit(t) > 0) fraction[t] = p_[t] / limit(t);
  return StepStatus::ok;
}

bool SurfaceStage::warm_start(const std::vector<Vec3>& away) {
  const int plane = rows[0].plane, n = int(rows.size());
  const Vec3& normal = normals_[plane];
  const double friction = friction_[plane];
  Delassus& delassus = set_.delassus();
  constexpr int columns = Delassus::together;  // three columns are used
  missed_ = 0;
  delassus.set_rows(rows);
  columns_.resize(columns * n);
  for (int t = 0; t < n; ++t) {
    double* to = &columns_[columns * t];
    for (int a = 0; a < 3; ++a) to[a] = -away[t][a];
    to[3] = 0;
  }
  delassus.solve_together(columns_.data());
  force_.resize(n);
  fraction.resize(n);
  for (int t = 0; t < n; ++t) {
    const double* from = &columns_[columns * t];
    force_[t] = Vec3(from[0], from[1], from[2]);
    const double load = normal.dot(force_[t]), limit = friction * load;
    const Vec3 rubbed = tangential(normal, force_[t]);
    if (!(load >= 0 && (friction == 0 || rubbed.squaredNorm() <= limit * limit))) return false;
    fraction[t] = limit > 0 ? Vec3(1 / limit * rubbed) : Vec3(Vec3::Zero());
  }
  find_move();
  add_motion(move_);
  return true;
}

bool SurfaceStage::warm_start_free(const std::vector<Vec3>& away) {
  Delassus& delassus = set_.delassus();
  missed_ = 0;
  delassus.list_rows(rows);
  delassus.stick(away, force_);
  fraction.resize(rows.size());
  for (std::size_t t = 0; t < rows.size(); ++t) {
    const Vec3& normal = normals_[rows[t].plane];
    const double load = normal.dot(force_[t]), most = friction_[rows[t].plane] * load;
    const Vec3 rubbed = tangential(normal, force_[t]);
    if (!(load >= 0 && rubbed.squaredNorm() <= most * most)) return false;
    fraction[t] = most > 0 ? Vec3(1 / most * rubbed) : Vec3(Vec3::Zero());
  }
  find_move();
  add_motion(move_);
  return true;
}

bool SurfaceStage::aligned(int p, int q) const { return std::abs(set_.delassus().cosine(p, q)) == 1; }

/// True if all current rows are on parallel planes. Friction then brings none of them nearer to its own plane.
bool SurfaceStage::parallel() const {
  return std::ranges::all_of(rows, [&](const SurfaceRow& row) { return aligned(rows[0].plane, row.plane); });
}

/// True if friction brings no sample behind a plane of another direction. The gaps above such planes lack friction and are computed anew.
bool SurfaceStage::stays_apart(double tolerance) {
  if (rows.empty()) return true;
  const Samples& samples = set_.delassus().samples();
  for (int q = 0; q < int(gaps.size()); ++q) {
    if (aligned(rows[0].plane, q)) continue;
    gaps[q] = begin_[q];
    gaps[q].add_motion(samples, range(), move_, normals_[q]);
  }
  for (Candidate& each : candidates) {
    if (aligned(rows[0].plane, each.row.plane)) continue;
    each.gap = gaps[each.row.plane].at(samples, each.row.sample) - each.bound;
    if (!(each.gap >= -tolerance)) return false;
  }
  return true;
}

/// Computes the friction at the current normal forces, starting from the friction of the rows active before.
void SurfaceStage::solve_friction(const std::function<Vec3(const SurfaceRow&)>& slip) {
  limits_.clear();
  slips_.clear();
  for (std::size_t t = 0, u = 0; t < rows.size(); ++t) {
    limits_.push_back(limit(t));
    slips_.push_back(tangential(normals_[rows[t].plane], slip(rows[t])));
    while (u < before_.size() && before_[u] < rows[t]) ++u;
    if (u < before_.size() && before_[u] == rows[t]) p_[t] = limits_[t] * fraction[u];
  }
  missed_ = disks_.solve({set_.delassus(), normals_, limits_, slips_}, p_);
}

/// Solves for all forces of the current rows together, then for the normal forces beside this friction, so that no sample is behind a
/// plane. Repeats both if other rows become active.
template <class Block>
StepStatus SurfaceStage::solve_all_forces(double tolerance, const std::function<Vec3(const SurfaceRow&)>& slip) {
  force_.assign(rows.size(), Vec3::Zero());
  auto& [law, problem] = std::get<Law<Block>>(laws_);
  for (int turn = 0; turn < most_turns; ++turn) {
    state_law<Block>(slip, turn == 0);
    const double left = law.solve(problem, operations(), force_);
    missed_ = left > problem.exact ? left / largest_free_ : 0;
    for (std::size_t t = 0; t < rows.size(); ++t) p_[t] = tangential(normals_[rows[t].plane], force_[t]);
    const std::vector<SurfaceRow> before = rows;
    if (const StepStatus status = solve_normal_forces(tolerance); status != StepStatus::ok) return status;
    if (std::includes(before.begin(), before.end(), rows.begin(), rows.end())) break;
    find_forces();
  }
  double excess = 0, largest = 0;
  for (std::size_t t = 0; t < rows.size(); ++t) {
    excess = std::max(excess, p_[t].norm() - limit(t));
    largest = std::max(largest, set_.forces()[t]);
  }
  if (largest > 0) missed_ = std::max(missed_, excess / largest);
  return StepStatus::ok;
}

/// States the problem of Coulomb's law at the current forces, which are zero at first.
template <class Block>
void SurfaceStage::state_law(const std::function<Vec3(const SurfaceRow&)>& slip, bool first) {
  const Delassus& g = set_.delassus();
  auto& problem = std::get<Law<Block>>(laws_).problem;
  const int n = int(rows.size());
  problem.normals.resize(n);
  problem.friction.resize(n);
  problem.g.resize(std::size_t(n) * n);
  problem.u.resize(n);
  problem.aims.clear();
  largest_free_ = 0;
  auto at = candidates.begin();
  for (int t = 0; t < n; ++t) {
    const auto [plane, sample] = rows[t];
    while (at->row < rows[t]) ++at;
    const Vec3& normal = problem.normals[t] = normals_[plane];
    problem.friction[t] = friction_[plane];
    const double gap = begin_[plane].at(g.samples(), sample) - at->bound;
    problem.u[t] = gap * normal + tangential(normal, slip(rows[t]));
    largest_free_ = std::max(largest_free_, problem.u[t].norm());
    for (int u = 0; u <= t; ++u) {
      if constexpr (std::is_same_v<Block, double>) {
        problem.g[t * n + u] = problem.g[u * n + t] = g(t, u);
      } else {
        problem.g[t * n + u] = g.block(t, u);
        problem.g[u * n + t] = problem.g[t * n + u].transpose();
      }
    }
    // what stuck sticks, and what slid slides on
    if (first) problem.aims.push_back(normal + problem.friction[t] * (fraction[t].norm() < slid ? 1 : slides_on) * fraction[t]);
  }
  for (int t = 0; t < n && !first; ++t)
    for (int u = 0; u < n; ++u) problem.u[t] += problem.g[t * n + u] * force_[u];
  problem.exact = exact_balance * largest_free_;
  operations().spend(n * (Operations::of_value + Operations::of_place + 10.0 * n));
}

/// Computes the normal forces at the current friction, which only active rows have.
StepStatus SurfaceStage::solve_normal_forces(double tolerance) {
  for (int round = 0; round < most_settlings; ++round) {
    gaps = begin_;
    set_.delassus().push(p_, move_);
    add_motion(move_);
    if (operations().spent()) return StepStatus::not_finite;
    if (const StepStatus status = set_.solve(candidates, gaps, tolerance); status != StepStatus::ok) return status;
    added_ = added_ || set_.added();
    if (set_.active() == rows) break;
    const std::vector<SurfaceRow> before = rows;
    const std::vector<Vec3> p = p_;
    rows = set_.active();
    p_.assign(rows.size(), Vec3::Zero());
    bool lost = false;
    for (std::size_t u = 0, t = 0; u < before.size(); ++u) {
      while (t < rows.size() && rows[t] < before[u]) ++t;
      if (t < rows.size() && rows[t] == before[u])
        p_[t] = p[u];
      else
        lost = lost || !p[u].isZero(0);
    }
    if (!lost) break;
  }
  return StepStatus::ok;
}

void SurfaceStage::find_forces() {
  force_.resize(rows.size());
  for (std::size_t t = 0; t < rows.size(); ++t) force_[t] = set_.forces()[t] * normals_[rows[t].plane] + p_[t];
}

void SurfaceStage::find_move() { set_.delassus().push(force_, move_); }

}  // namespace softffd
