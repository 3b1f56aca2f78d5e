#include "contact/coulomb_rows.hpp"

#include <algorithm>
#include <cmath>

#include "contact/elimination.hpp"
#include "machine/instructions.hpp"
#include "model/plane.hpp"

namespace softffd {

namespace {

/// Largest number of Newton steps in a row, which may diverge for twenty steps before they converge; number of sweeps that follow, which
/// doubles in each round; largest number of rounds.
constexpr int most_newton = 50, first_sweeps = 4, most_rounds = 8;
/// Fraction of a row's own compliance that is added to its diagonal, so that the equations of linearly dependent rows can be solved.
constexpr double regular = 1e-11;

using Mat3 = Eigen::Matrix3d;

/// Operations for a row, for a pair of rows, for a pair of sliding rows, and for each block operation in the elimination of sticking rows.
constexpr double own_work = 100, row_work = 16, sliding_work = 40;
template <class Block>
constexpr double block_work = std::is_same_v<Block, Mat3> ? 8 : 2;

double mean(double block) { return block; }
double mean(const Mat3& block) { return block.trace() / 3; }
double transposed(double block) { return block; }
Mat3 transposed(const Mat3& block) { return block.transpose(); }

/// Returns the projection of an aim onto the forces that the law allows.
INNER Vec3 allowed(const Vec3& normal, double friction, const Vec3& aim) {
  const double load = std::max(0.0, normal.dot(aim)), limit = friction * load;
  const Vec3 across = tangential(normal, aim);
  const double square = across.squaredNorm();
  return load * normal + (square <= limit * limit ? 1 : limit / std::sqrt(square)) * across;
}

}  // namespace

template <class Block>
double CoulombRows<Block>::solve(const Problem& problem, Operations& operations, std::vector<Vec3>& force) {
  const int n = int(force.size());
  own_.resize(n);
  for (int s = 0; s < n; ++s) own_[s] = mean(problem.g[s * n + s]);
  start_ = force;
  u_ = problem.u;
  double best = look(problem, force);
  best_ = force;
  if (!problem.aims.empty()) aims_ = problem.aims;
  const auto keep = [&] {
    find_displacements(problem, force);
    const double now = look(problem, force);
    if (!(now < best)) return;
    best = now;
    best_ = force;
  };
  for (int round = 0, sweeps = first_sweeps; round < most_rounds && best > problem.exact && !operations.spent(); ++round, sweeps *= 2) {
    for (int i = 0; i < most_newton && best > problem.exact && newton_step(problem, operations, force); ++i) keep();
    if (best <= problem.exact) break;
    force = best_;
    for (int i = 0; i < sweeps && !operations.spent(); ++i) {
      operations.spend(row_work * n * n);
      sweep(problem, force);
    }
    keep();
  }
  force = best_;
  return best;
}

template <class Block>
void CoulombRows<Block>::find_displacements(const Problem& problem, const std::vector<Vec3>& force) {
  const int n = int(force.size());
  u_ = problem.u;
  for (int t = 0; t < n; ++t) {
    const Vec3 more = force[t] - start_[t];
    const Block* moved = &problem.g[t * n];
    for (int s = 0; s < n; ++s) u_[s] += transposed(moved[s]) * more;
  }
}

/// Computes the aims at the present displacements. Returns the largest violation of the law [m].
template <class Block>
double CoulombRows<Block>::look(const Problem& problem, const std::vector<Vec3>& force) {
  const int n = int(force.size());
  aims_.resize(n);
  double worst = 0;
  for (int s = 0; s < n; ++s) {
    aims_[s] = force[s] - u_[s] / own_[s];
    worst = std::max(worst, own_[s] * (force[s] - allowed(problem.normals[s], problem.friction[s], aims_[s])).norm());
  }
  return worst;
}

/// Takes a Newton step from forces whose aims are known. Returns false if the operations are spent or there is no finite solution.
template <class Block>
bool CoulombRows<Block>::newton_step(const Problem& problem, Operations& operations, std::vector<Vec3>& force) {
  ++iterations_;
  sort(problem);
  operations.spend(newton_work());
  if (operations.spent()) return false;
  const int m = int(touching_.size());
  change_.resize(m);
  for (int i = 0; i < m; ++i) change_[i] = -u_[touching_[i]];
  let_go(problem, force);
  assemble(problem);
  matrix_.eliminate(change_);
  if (!solve_sliding(problem, force)) return false;
  matrix_.substitute(change_);
  for (int i = 0; i < m; ++i) force[touching_[i]] += change_[i];
  return true;
}

/// Assembles G of the touching rows, sticking rows first.
template <class Block>
void CoulombRows<Block>::assemble(const Problem& problem) {
  const int n = int(aims_.size()), m = int(touching_.size()), sticking = int(sticking_.size());
  matrix_.resize(sticking, m);
  for (int j = 0; j < m; ++j) {
    const Block* row = &problem.g[touching_[j] * n];
    for (int i = j; i < m; ++i) matrix_.set(i, j, row[touching_[i]]);
    if (j < sticking) matrix_.add_to_diagonal(j, regular * own_[touching_[j]]);
  }
}

template <class Block>
double CoulombRows<Block>::newton_work() const {
  const double n = double(aims_.size()), m = double(touching_.size()), k = double(sliding_.size());
  const double eliminated = (m * m * m - k * k * k) / 6, sliding = 8 * k * k * k / 3;
  return own_work * n + row_work * n * n + block_work<Block> * eliminated + sliding_work * k * k + sliding;
}

/// Sorts the rows into open, sticking and sliding ones by the directions of their aims.
template <class Block>
void CoulombRows<Block>::sort(const Problem& problem) {
  for (auto* each : {&sticking_, &rest_, &touching_}) each->clear();
  sliding_.clear();
  for (int s = 0; s < int(aims_.size()); ++s) {
    const Vec3& normal = problem.normals[s];
    const Vec3 across = tangential(normal, aims_[s]);
    const double friction = problem.friction[s], limit = friction * normal.dot(aims_[s]), size = across.norm();
    const bool open = normal.dot(aims_[s]) <= 0;
    if (!open && friction > 0 && size <= limit) {
      sticking_.push_back(s);
      continue;
    }
    rest_.push_back(s);
    if (open) continue;
    touching_.push_back(s);
    const Vec3 aim = size > 0 ? Vec3(across / size) : Vec3(Vec3::Zero());
    sliding_.push_back({normal + friction * aim, normal.cross(aim), size > 0 ? limit / size : 0});
  }
  touching_.insert(touching_.begin(), sticking_.begin(), sticking_.end());
}

/// Removes the forces of open rows, and the part of the forces of sliding rows that is neither along their aim nor across it.
template <class Block>
void CoulombRows<Block>::let_go(const Problem& problem, std::vector<Vec3>& force) {
  const int n = int(force.size());
  auto slides = sliding_.begin();
  for (const int s : rest_) {
    Vec3 gone = force[s];
    if (problem.normals[s].dot(aims_[s]) > 0) {
      gone -= problem.normals[s].dot(force[s]) * slides->along + slides->across.dot(force[s]) * slides->across;
      ++slides;
    }
    force[s] -= gone;
    for (std::size_t i = 0; i < touching_.size(); ++i) change_[i] += problem.g[touching_[i] * n + s] * gone;
  }
}

/// Solves for the sliding rows: `change_`, the displacements that are left to be undone, becomes the change of their forces. Returns false
/// if there is no finite solution.
template <class Block>
bool CoulombRows<Block>::solve_sliding(const Problem& problem, const std::vector<Vec3>& force) {
  const int m = int(touching_.size()), first = int(sticking_.size()), k = m - first, size = 2 * k;
  if (k == 0) return true;
  slopes_.resize(std::size_t(size) * size);
  right_.resize(size);
  for (int i = 0; i < k; ++i) {
    const int at = first + i, s = touching_[at];
    const Sliding& own = sliding_[i];
    const Vec3 &normal = problem.normals[s], turned = own.turn / own_[s] * own.across;
    double *top = &slopes_[std::size_t(2 * i) * size], *below = top + size;
    for (int j = 0; j < k; ++j) {
      const Block block = i >= j ? matrix_.left(at, first + j) : transposed(matrix_.left(first + j, at));
      const Vec3 along = block * sliding_[j].along, across = block * sliding_[j].across;
      top[2 * j] = normal.dot(along);
      top[2 * j + 1] = normal.dot(across);
      below[2 * j] = turned.dot(along);
      below[2 * j + 1] = turned.dot(across);
    }
    top[2 * i] += regular * own_[s];
    below[2 * i + 1] += 1 - own.turn;
    right_[2 * i] = normal.dot(change_[at]);
    right_[2 * i + 1] = turned.dot(change_[at]) - (1 - own.turn) * own.across.dot(force[s]);
  }
  if (!eliminate(size, slopes_, right_)) return false;
  for (int i = 0; i < k; ++i) change_[first + i] = right_[2 * i] * sliding_[i].along + right_[2 * i + 1] * sliding_[i].across;
  return true;
}

template <class Block>
void CoulombRows<Block>::sweep(const Problem& problem, std::vector<Vec3>& force) {
  const int n = int(force.size());
  for (int s = 0; s < n; ++s) {
    Vec3 u = problem.u[s];
    for (int t = 0; t < n; ++t) u += problem.g[s * n + t] * (force[t] - start_[t]);
    force[s] = allowed(problem.normals[s], problem.friction[s], force[s] - u / own_[s]);
  }
}

template class CoulombRows<double>;
template class CoulombRows<Mat3>;

}  // namespace softffd
