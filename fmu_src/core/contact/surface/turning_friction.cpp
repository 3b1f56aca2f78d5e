/// Friction on planes of different directions, where it presses samples against other planes.
#include <algorithm>

#include "contact/surface/surface_stage.hpp"
#include "model/plane.hpp"

namespace softffd {

namespace {

/// Turns between normal forces and friction, and the share of the largest move by which the last may still have changed anything.
constexpr int most_turns = 30;
constexpr double settled = 1e-12;
/// A turn in which friction misses its law by more, in parts of the slip, is the last: what crowds there no turn disentangles.
constexpr double solvable = 1e-9;
/// Up to so many rows sweeps over them, forces and friction of one at a time, cost less than turns.
constexpr std::size_t few_rows = 6;
/// Sweeps, fewer where there are many rows; the share of the largest force that they may still change; and rounds of them with rows that
/// have come to be active. What they leave undone the next step goes on with.
constexpr int least_sweeps = 10, most_exact_sweeps = 200, swept = 20'000, most_exact_rounds = 4;
constexpr double balanced = 1e-13;
/// Rows that lose their normal force to friction one after the other, at most: each round has lost one.
constexpr int most_settlings = 1000;

}  // namespace

StepStatus SurfaceStage::take_turns(double tolerance) {
  bool rests = false;
  move_.setZero(set_.delassus().samples().lattice().points(), 3);
  last_move_ = move_;
  const bool few = rows.size() <= few_rows;
  for (const bool sweeps : {few, !few}) {
    const StepStatus status = sweeps ? balance(tolerance, rests) : alternate(tolerance, rests);
    if (status != StepStatus::ok || rests) return status;
  }
  double excess = 0, largest = 0;
  for (std::size_t t = 0; t < rows.size(); ++t) {
    excess = std::max(excess, p_[t].norm() - friction_[rows[t].plane] * set_.forces()[t]);
    largest = std::max(largest, set_.forces()[t]);
  }
  if (largest > 0) missed_ = excess / largest;
  return StepStatus::ok;
}

/// Friction at the normal forces, normal forces at the friction.
StepStatus SurfaceStage::alternate(double tolerance, bool& rests) {
  for (int turn = 0; turn < most_turns && !rests; ++turn) {
    const bool solved = rub(false) <= solvable;
    if (const StepStatus status = settle(tolerance); status != StepStatus::ok) return status;
    rests = change() <= settled;
    if (!solved && !rests) return StepStatus::ok;
    for (std::size_t t = 0; t < rows.size(); ++t) {
      const double limit = friction_[rows[t].plane] * set_.forces()[t];
      share[t] = limit > 0 ? Vec3(p_[t] / limit) : Vec3::Zero();
    }
  }
  return StepStatus::ok;
}

/// Row by row: what keeps it from its plane, and what stops it or rubs against its slip.
StepStatus SurfaceStage::balance(double tolerance, bool& rests) {
  std::vector<double> normal;
  for (int round = 0; round < most_exact_rounds && !rests; ++round) {
    wanted_.clear();
    whole_slip_.clear();
    for (const SurfaceRow& row : rows) {
      const auto at = std::lower_bound(candidates.begin(), candidates.end(), row,
                                       [](const Candidate& candidate, const SurfaceRow& r) { return candidate.row < r; });
      wanted_.push_back(at->bound - begin_[row.plane].at(set_.delassus().samples(), row.sample));
      whole_slip_.push_back((*slip_of_)(row));
    }
    normal = set_.forces();
    bool done = false;
    const int sweeps = std::clamp(swept / int(rows.size() * rows.size() + 1), least_sweeps, most_exact_sweeps);
    for (int i = 0; i < sweeps && !done; ++i) done = sweep(normal);
    const std::vector<SurfaceRow> before = rows;
    if (const StepStatus status = settle(tolerance); status != StepStatus::ok) return status;
    change();
    rests = done && std::includes(before.begin(), before.end(), rows.begin(), rows.end());
  }
  return StepStatus::ok;
}

/// Returns whether it has changed next to nothing.
bool SurfaceStage::sweep(std::vector<double>& normal) {
  const Delassus& g = set_.delassus();
  double largest = 0, changed = 0;
  for (std::size_t t = 0; t < rows.size(); ++t) {
    const Vec3& n = normals_[rows[t].plane];
    Vec3 moved = Vec3::Zero();
    for (std::size_t u = 0; u < rows.size(); ++u)
      if (u != t) moved += g(int(t), int(u)) * (normal[u] * normals_[rows[u].plane] + p_[u]);
    const double own = g(int(t), int(t)), before = normal[t], limit = friction_[rows[t].plane];
    const Vec3 slip = tangential(n, whole_slip_[t] + moved), rubbed = p_[t];
    normal[t] = std::max(0.0, (wanted_[t] - n.dot(moved)) / own);
    const double size = slip.norm();
    p_[t] = size <= limit * normal[t] * own ? Vec3(-slip / own) : Vec3(-limit * normal[t] / size * slip);
    largest = std::max(largest, normal[t]);
    changed = std::max({changed, std::abs(normal[t] - before), (p_[t] - rubbed).norm()});
  }
  return changed <= balanced * largest;
}

/// The normal forces at this friction, which only active rows have.
StepStatus SurfaceStage::settle(double tolerance) {
  for (int round = 0; round < most_settlings; ++round) {
    heights = begin_;
    set_.delassus().push(p_, rubbed_);
    raise(rubbed_);
    if (const StepStatus status = set_.solve(candidates, heights, tolerance); status != StepStatus::ok) return status;
    if (set_.active() == rows) return StepStatus::ok;
    const std::vector<SurfaceRow> before = rows;
    rows = set_.active();
    carry(before);
    const bool lost = std::any_of(before.begin(), before.end(),
                                  [&](const SurfaceRow& row) { return !std::binary_search(rows.begin(), rows.end(), row); });
    if (!lost) return StepStatus::ok;
  }
  return StepStatus::not_finite;
}

/// Friction and its shares from rows that were active to those that are.
void SurfaceStage::carry(const std::vector<SurfaceRow>& from) {
  std::vector<Vec3> p(rows.size(), Vec3::Zero()), shares = p;
  for (std::size_t t = 0; t < rows.size(); ++t) {
    const auto at = std::lower_bound(from.begin(), from.end(), rows[t]);
    if (at == from.end() || *at != rows[t]) continue;
    p[t] = p_[at - from.begin()];
    shares[t] = share[at - from.begin()];
  }
  p_.swap(p);
  share.swap(shares);
}

/// By what share of the move from y0 this turn has changed it.
double SurfaceStage::change() {
  last_move_.swap(move_);
  find_forces();
  find_move();
  const double size = move_.abs().maxCoeff();
  return size > 0 ? (move_ - last_move_).abs().maxCoeff() / size : 0;
}

}  // namespace softffd
