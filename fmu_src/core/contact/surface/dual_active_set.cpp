#include "contact/surface/dual_active_set.hpp"

#include <algorithm>

#include "contact/implicit/step_delassus.hpp"
#include "model/arithmetic.hpp"

namespace softffd {

namespace {

/// Fraction of a row's own compliance that the active rows must leave so that the row can be appended; fraction at or below which the row
/// depends on them.
constexpr double independent = 1e-10, dependent = 1e-14;
/// Response below which a row does not unload another.
constexpr double no_response = 1e-12;
/// Largest number of violated rows that are evaluated first.
constexpr std::size_t looked_at = 32;
/// Largest number of rows that are added, and that are dropped for one added row.
constexpr int most_additions = 1000, most_drops = 300;
/// After this many additions, plus two for each candidate, violations may be due to rounding: rows that nearly depend on each other then
/// violate one another in turn. Factor by which the tolerance grows with each further addition, and its largest total factor.
constexpr std::size_t sure_additions = 100;
constexpr double tolerance_growth = 1.1, most_growth = 1e3;

}  // namespace

template <class Metric>
StepStatus DualActiveSetIn<Metric>::solve(std::vector<Candidate>& candidates, std::vector<GapFunction>& gaps, double tolerance,
                                          const std::vector<double>& known) {
  gap_functions_ = &gaps;
  pinned_ = 0;
  hot_.clear();
  at_hand_.assign(candidates.size(), 0);
  begin_ = gaps;
  bounds_.clear();
  std::size_t c = 0;
  for (const SurfaceRow& row : active()) {
    while (c < candidates.size() && candidates[c].row < row) ++c;
    if (c == candidates.size() || candidates[c].row != row) return StepStatus::not_finite;  // an active row is not among the candidates
    at_hand_[c] = 1;
    bounds_.push_back(candidates[c].bound);
  }
  known_ = known;
  known_.resize(bounds_.size(), 0.0);
  find_wanted();
  warm();
  if (active().size() != std::size_t(std::count(at_hand_.begin(), at_hand_.end(), 1))) {
    for (std::size_t i = 0, t = 0; i < candidates.size(); ++i)
      if (at_hand_[i] == 1 && !(t < active().size() && active()[t] == candidates[i].row && ++t)) at_hand_[i] = 0;
  }
  if (active().empty())
    gaps = begin_;
  else
    spread();
  const double most = most_growth * tolerance;
  for (int round = 0; round < most_additions; ++round) {
    if (std::size_t(round) >= sure_additions + 2 * candidates.size()) tolerance = std::min(tolerance_growth * tolerance, most);
    delassus_.operations().spend(Operations::of_value * double(candidates.size()));
    if (delassus_.operations().spent()) return StepStatus::not_finite;
    const int chosen = most_violated(candidates, tolerance);
    added_ = round > 0;
    if (chosen < 0) {
      if (added_) {
        sort(candidates);
        renew_forces();
        most_violated(candidates, tolerance);
      }
      if (refine(candidates, tolerance)) spread();
      return StepStatus::ok;
    }
    if (const StepStatus status = add(candidates, chosen); status != StepStatus::ok) return status;
  }
  return StepStatus::not_finite;
}

/// Finds the forces of the rows that were active, and drops rows that would pull, so that the start has l >= 0.
template <class Metric>
void DualActiveSetIn<Metric>::warm() {
  while (true) {
    find_forces();
    const auto least = std::min_element(forces_.begin(), forces_.end());
    if (least == forces_.end() || *least >= 0) return;
    leave(int(least - forces_.begin()));
  }
}

/// Computes the gap functions with the present forces.
template <class Metric>
void DualActiveSetIn<Metric>::spread() {
  scratch_ = forces_;
  for (std::size_t t = 0; t < forces_.size(); ++t) scratch_[t] -= known_[t];
  delassus_.apply_impulses(scratch_, begin_, *gap_functions_);
}

/// Makes the row inactive, and removes its force from y0.
template <class Metric>
void DualActiveSetIn<Metric>::leave(int row, typename Metric::Column* column) {
  const double part = known_[row];
  if (part != 0) {
    scratch_.assign(known_.size(), 0.0);
    scratch_[row] = -part;
    delassus_.apply_impulses(scratch_, begin_, begin_);
  }
  for (auto* each : {&forces_, &known_, &bounds_, &wanted_}) each->erase(each->begin() + row);
  delassus_.drop(row, column);
  if (part != 0) find_wanted();
}

template <class Metric>
void DualActiveSetIn<Metric>::find_wanted() {
  wanted_.resize(bounds_.size());
  for (std::size_t t = 0; t < bounds_.size(); ++t) wanted_[t] = bounds_[t] - height(active()[t], begin_);
}

template <class Metric>
void DualActiveSetIn<Metric>::find_forces() {
  forces_ = wanted_;
  delassus_.solve(forces_.data());
  for (std::size_t t = 0; t < forces_.size(); ++t) forces_[t] += known_[t];
}

/// Sorts the active rows into the order of the candidates.
template <class Metric>
void DualActiveSetIn<Metric>::sort(const std::vector<Candidate>& candidates) {
  std::vector<std::pair<SurfaceRow, double>> known;
  for (std::size_t t = 0; t < known_.size(); ++t) known.push_back({active()[t], known_[t]});
  std::sort(known.begin(), known.end());
  delassus_.sort();
  known_.clear();
  bounds_.clear();
  for (const auto& [row, part] : known) known_.push_back(part);
  for (std::size_t c = 0; c < candidates.size(); ++c)
    if (at_hand_[c] == 1) bounds_.push_back(candidates[c].bound);
  find_wanted();
}

/// Returns the index of the most violated candidate that is not active; the first one among equals; -1: none. The few that were most
/// violated when all were last evaluated are evaluated alone until they are met.
template <class Metric>
int DualActiveSetIn<Metric>::most_violated(std::vector<Candidate>& candidates, double tolerance) {
  int worst = -1;
  double least = -tolerance;
  const auto look = [&](int c) {
    Candidate& candidate = candidates[c];
    candidate.gap = height(candidate.row, *gap_functions_) - candidate.bound;
    return candidate.gap;
  };
  for (const int c : hot_) {
    if (at_hand_[c]) continue;
    const double gap = look(c);
    if (gap < least || (gap == least && worst >= 0 && c < worst)) least = gap, worst = c;
  }
  if (worst >= 0) return worst;
  violated_.clear();
  for (int c = 0; c < int(candidates.size()); ++c) {
    const double gap = look(c);
    if (gap < -tolerance && at_hand_[c] == 0) violated_.push_back({gap, c});
  }
  hot_.clear();
  if (violated_.empty()) return -1;
  if (violated_.size() > looked_at) {
    std::nth_element(violated_.begin(), violated_.begin() + looked_at, violated_.end());
    violated_.resize(looked_at);
  }
  std::sort(violated_.begin(), violated_.end());
  expected_.clear();
  for (const auto& [gap, c] : violated_) {
    hot_.push_back(c);
    expected_.push_back(candidates[c].row.sample);
  }
  delassus_.expect(expected_);
  return violated_.front().second;
}

template <class Metric>
StepStatus DualActiveSetIn<Metric>::add(const std::vector<Candidate>& candidates, int chosen) {
  const Candidate& candidate = candidates[chosen];
  delassus_.prepare(candidate.row, column_);
  if (column_.own == 0) {
    at_hand_[chosen] = 2;
    pinned_ = std::max(pinned_, -candidate.gap);
    return StepStatus::ok;
  }
  double gap = candidate.gap, force = 0;
  for (int drops = 0; drops <= most_drops && !delassus_.operations().spent(); ++drops) {
    double unload = infinity;
    int first = -1;
    for (int t = 0; t < int(forces_.size()); ++t)
      if (column_.response[t] > no_response && forces_[t] / column_.response[t] < unload)
        unload = forces_[t] / column_.response[t], first = t;
    double met = column_.left > independent * column_.own ? -gap / column_.left : infinity;
    if (met == infinity && unload == infinity) {
      if (!(column_.left > dependent * column_.own)) return StepStatus::impossible_planes;
      met = -gap / column_.left;
    }
    const double by = std::min(met, unload);
    for (std::size_t t = 0; t < forces_.size(); ++t) forces_[t] -= by * column_.response[t];
    force += by;
    gap += by * column_.left;
    if (met <= unload) {
      delassus_.append(column_);
      at_hand_[chosen] = 1;
      forces_.push_back(force);
      known_.push_back(0);
      bounds_.push_back(candidate.bound);
      wanted_.push_back(candidate.bound - height(candidate.row, begin_));
      renew_forces();
      return StepStatus::ok;
    }
    if (first < 0) return StepStatus::not_finite;  // the gap is not a number
    const SurfaceRow leaving = active()[first];
    at_hand_[std::lower_bound(candidates.begin(), candidates.end(), leaving,
                              [](const Candidate& a, const SurfaceRow& b) { return a.row < b; }) -
             candidates.begin()] = 0;
    leave(first, &column_);
  }
  return StepStatus::not_finite;
}

/// Solves for the forces again with the factor, so that rounding does not accumulate.
template <class Metric>
void DualActiveSetIn<Metric>::renew_forces() {
  find_forces();
  for (double& force : forces_) force = std::max(force, 0.0);
  spread();
}

/// Corrects the forces for the gaps that rounding has left at the active rows. Returns whether the forces have changed.
template <class Metric>
bool DualActiveSetIn<Metric>::refine(const std::vector<Candidate>& candidates, double tolerance) {
  scratch_.clear();
  double worst = 0;
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    if (at_hand_[c] != 1) continue;
    scratch_.push_back(-candidates[c].gap);
    worst = std::max(worst, std::abs(candidates[c].gap));
  }
  if (!(worst > 0.1 * tolerance)) return false;
  delassus_.solve(scratch_.data());
  for (std::size_t t = 0; t < forces_.size(); ++t)
    if (forces_[t] + scratch_[t] < 0) return false;
  for (std::size_t t = 0; t < forces_.size(); ++t) forces_[t] += scratch_[t];
  return true;
}

template class DualActiveSetIn<Delassus>;
template class DualActiveSetIn<StepDelassus>;

}  // namespace softffd
