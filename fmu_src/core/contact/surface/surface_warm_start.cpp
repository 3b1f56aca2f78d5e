/// Lasting contact with one plane, in most steps of a body that rests, rolls or sways: the samples that touched before touch again, all
/// of them press and stick, and no other sample has come near. This solution is found from the rows of the state alone, without a list of
/// candidates, and is checked afterwards. If the check fails, the stage is solved from its beginning. If a long list of samples is near,
/// that solution too is first tried with the rows of the state alone, of which some may slide.
#include <algorithm>

#include "contact/surface/surface_contact.hpp"
#include "contact/surface/surface_loops.hpp"
#include "contact/tolerances.hpp"

namespace softffd {

/// Takes over the rows of the state. False if there are none, or if they are not all on one plane that is no half-space of a solid.
bool SurfaceContact::recall(const std::vector<Count>& numbers, SurfaceStage& stage) const {
  std::vector<SurfaceRow>& rows = stage.rows;
  std::size_t n = 0;
  bool known = true;
  for (; n < numbers.size() && numbers[n] >= 0; ++n)
    known = known && n < rows.size() && rows[n].plane < flat_ && number(rows[n]) == numbers[n];
  if (n == 0) return false;
  if (!known || rows.size() != n) {
    rows.clear();
    for (std::size_t t = 0; t < n; ++t) {
      const SurfaceRow row = row_of(numbers[t]);
      if (row.plane >= flat_ || (t > 0 && !(rows.back() < row))) return false;  // a state may hold anything
      rows.push_back(row);
    }
  }
  return rows.front().plane == rows.back().plane;
}

/// Solves the drift's stage by the rows of the state, if all of them press and stick. False if not.
bool SurfaceContact::warm_start_drift(const StepView& step, const Points& v, const Points& x1, const SurfaceRows& rows) {
  if (solids_ || drift_.free() || !recall(rows.drift, drift_)) return false;
  const int q = drift_.rows.front().plane;
  const HalfSpace& plane = end_[q];
  at_hand_.set(drift_.rows);
  at_hand_.at(step.x0, begin_);
  at_hand_.at(x1, places_);
  away_.resize(places_.size());
  for (std::size_t t = 0; t < away_.size(); ++t) {
    if (start_[q].gap(begin_[t]) > touching * length_) return false;  // the sample arrives in this step
    Vec3 slip = places_[t] - begin_[t];
    if (!still_[q]) slip -= step.h * middle_[q].material_velocity(0.5 * (begin_[t] + places_[t]));
    away_[t] = plane.gap(places_[t]) * plane.normal;
    if (friction_[q] > 0) away_[t] += tangential(plane.normal, slip);
  }
  if (!drift_.warm_start(away_)) return false;
  if (!list_warm_started(step.h, v)) {
    touching_.clear();
    find_gaps(x1);
    return false;
  }
  for (std::size_t t = 0; t < away_.size(); ++t) places_[t] -= away_[t];
  lands_ = false;
  return true;
}

/// Does the same for rows on solids, beside free bodies.
bool SurfaceContact::warm_start_free_drift(const StepView& step, const Points& x1, const SurfaceRows& rows) {
  const double slack = slack_of_rows(), touch = touching * length_;
  std::vector<SurfaceRow>& held = drift_.rows;
  held.clear();
  away_.clear();
  places_.clear();
  for (const Count number : rows.drift) {
    if (number < 0) break;
    const auto [obstacle, sample] = row_of(number);
    const int at = obstacle < flat_ ? -1 : tangents_.index(obstacle, sample);
    if (at < 0) return false;
    const int q = flat_ + at;
    const Vec3 begin = samples_.at(sample, step.x0), free = samples_.at(sample, x1);
    if (start_[q].gap(begin) > touch) return false;  // the sample arrives in this step
    const Vec3 slip = free - begin - step.h * middle_[q].material_velocity(0.5 * (begin + free));
    held.push_back({q, sample});
    away_.push_back(end_[q].gap(free) * end_[q].normal);
    if (friction_[q] > 0)
      away_.back() += tangential(end_[q].normal, slip);
    else
      return false;  // sliding rows are left to the full solution
    places_.push_back(free);
  }
  if (held.empty() || !std::ranges::is_sorted(held)) return false;
  const std::vector<GapFunction> before = drift_.gaps;
  bool holds = drift_.warm_start_free(away_) && tangents_.covers(tangents_.way(step.x0, x1 + drift_.move()) + obstacles_way(step.around));
  const auto see = [&](int q, int sample) {
    const double gap = drift_.gaps[q].at(samples_, sample);
    holds = holds && gap >= -slack;
    if (gap <= touch) touching_.push_back({.row = {q, sample}, .gap = gap});
  };
  for (int q = 0; q < flat_ && holds; ++q) {
    if (!search_.covers(q, drift_.gaps[q].of_points)) search(q, drift_.gaps[q].of_points, 0);
    for (const int s : search_.near(q)) see(q, s);
  }
  for (int q = flat_; q < int(end_.size()) && holds; ++q) see(q, tangents_.found()[q - flat_].sample);
  if (!holds) {
    touching_.clear();
    drift_.gaps = before;
    return false;
  }
  for (std::size_t t = 0; t < held.size(); ++t) places_[t] += samples_.at(held[t].sample, drift_.move());
  lands_ = false;
  return true;
}

bool SurfaceContact::warm_start_free_close(const StepView& step, const Points& v) {
  const std::vector<SurfaceRow>& rows = close_.rows;
  if (rows.empty() ||
      std::ranges::any_of(rows, [&](const SurfaceRow& row) { return row.plane < flat_ || own(row) || !(friction_[row.plane] > 0); }))
    return false;
  double fastest = largest_speed(v);
  std::vector<double> bounds;
  find_speeds(v);
  const auto material = [&](const SurfaceRow& row) { return end_[row.plane].material_velocity(begin_of(row, step.x0)); };
  away_.clear();
  for (const SurfaceRow& row : rows) away_.push_back(samples_.at(row.sample, v) - material(row));
  for (const Candidate& each : touching_) {
    bounds.push_back(end_[each.row.plane].normal.dot(material(each.row)));
    fastest = std::max(fastest, std::abs(bounds.back()));
  }
  slack_ = row_slack * fastest;
  if (!close_.warm_start_free(away_)) return false;
  for (std::size_t c = 0; c < touching_.size(); ++c) {
    const SurfaceRow& row = touching_[c].row;
    if (!(close_.gaps[row.plane].at(samples_, row.sample) >= bounds[c] - velocity_slack * fastest)) return false;
  }
  return true;
}

/// True if after the drift the current rows are on their plane and all other samples are in front of theirs. Lists the samples that
/// touch. If many samples are near, and no control point that counts for one of them is behind the plane, lists the rows alone.
bool SurfaceContact::list_warm_started(double h, const Points& v) {
  const double slack = slack_of_rows();
  const std::vector<SurfaceRow>& rows = drift_.rows;
  const int own = rows.front().plane;
  bool alone = true;
  for (int q = 0; q < flat_; ++q) {
    if (!search_.covers(q, drift_.gaps[q].of_points)) search(q, drift_.gaps[q].of_points, h * largest_speed(v));
    alone = alone && (q == own || search_.near(q).empty());
  }
  at_hand_.at(drift_.gaps[own].of_points, gaps_);
  for (const double gap : gaps_)
    if (!(std::abs(gap) <= slack)) return false;
  if (alone && !holds_ && search_.is_long(own) && search_.in_front(own, drift_.gaps[own].of_points, 0.5 * slack)) {
    for (std::size_t t = 0; t < rows.size(); ++t) touching_.push_back({.row = rows[t], .gap = gaps_[t]});
    known_ = own;
    return true;
  }
  std::size_t found = 0;
  for (int q = 0; q < flat_; ++q)
    for (const int s : search_.near(q)) {
      const bool row = found < rows.size() && rows[found] == SurfaceRow{q, s};
      const double gap = row ? gaps_[found++] : drift_.gaps[q].at(samples_, s);
      if (!(gap >= -slack)) return false;
      if (gap <= touching * length_) touching_.push_back({.row = {q, s}, .gap = gap});
    }
  return found == rows.size();
}

/// Solves the closing's stage by its rows, if all of them press and stick and the candidates stay in front of their planes. False if not.
bool SurfaceContact::warm_start_close(const StepView& step, const Points& v, const std::vector<Candidate>& candidates) {
  const std::vector<SurfaceRow>& rows = close_.rows;
  if (close_.free() || rows.empty() || rows.front().plane != rows.back().plane || rows.front().plane >= flat_) return false;
  const int own = rows.front().plane;
  const HalfSpace& plane = end_[own];
  const bool turns = !plane.spin.isZero(0);
  at_hand_.set(rows);
  if (turns && !places_known_) at_hand_.at(step.x0, places_);
  at_hand_.at(v, begin_);
  double fastest = std::sqrt(kernels::speeds(step.body.points(), plane.normal.data(), v.data(), close_.gaps[own].of_points.data()));
  find_speeds(v, own);
  away_.resize(rows.size());
  bounds_.resize(rows.size());
  for (std::size_t t = 0; t < rows.size(); ++t) {
    const Vec3 material = turns ? plane.material_velocity(places_[t]) : plane.velocity, slip = begin_[t] - material;
    bounds_[t] = plane.normal.dot(material);
    away_[t] = friction_[own] > 0 ? slip : Vec3(plane.normal.dot(slip) * plane.normal);
    fastest = std::max(fastest, std::abs(bounds_[t]));
  }
  slack_ = row_slack * fastest;
  if (!close_.warm_start(away_)) return false;
  at_hand_.at(close_.gaps[own].of_points, gaps_);
  for (std::size_t t = 0; t < rows.size(); ++t)
    if (!(std::abs(gaps_[t] - bounds_[t]) <= slack_)) return false;
  const double slack = velocity_slack * fastest;
  if (known_ >= 0 && !turns && search_.in_front(known_, close_.gaps[known_].of_points, 0.5 * slack - plane.normal.dot(plane.velocity)))
    return true;
  if (known_ >= 0) list_touching();
  for (std::size_t c = 0, t = 0; c < candidates.size(); ++c) {
    const SurfaceRow& row = candidates[c].row;
    while (t < rows.size() && rows[t] < row) ++t;
    if (t < rows.size() && rows[t] == row) continue;
    const HalfSpace& its = end_[row.plane];
    const bool its_turns = !its.spin.isZero(0);
    const double bound = its.normal.dot(its_turns ? its.material_velocity(samples_.at(row.sample, step.x0)) : its.velocity);
    if (!(close_.gaps[row.plane].at(samples_, row.sample) >= bound - slack)) return false;
  }
  return true;
}

/// Does what `fit` does, for the rows of the state alone, which may stick or slide. If the list is long and its samples are then in front
/// of the plane, the full list would give the same result to the bit.
bool SurfaceContact::fit_known(const std::vector<Count>& rows, const Points& friction, double tolerance, const Slip& slip) {
  known_ = -1;
  int near = -1;
  for (int q = 0; q < flat_; ++q) {
    if (search_.near(q).empty()) continue;
    if (near >= 0 || !search_.is_long(q)) return false;
    near = q;
  }
  if (near < 0 || holds_ || solids_ || drift_.free()) return false;
  drift_.candidates.clear();
  const std::vector<int>& list = search_.near(near);
  for (std::size_t t = 0; t < rows.size() && rows[t] >= 0; ++t)
    if (const SurfaceRow row = row_of(rows[t]); row.plane == near && std::binary_search(list.begin(), list.end(), row.sample))
      drift_.candidates.push_back({.row = row});
  if (drift_.candidates.empty()) return false;
  load(rows, friction, drift_);
  if (drift_.solve(tolerance, slip) != StepStatus::ok || drift_.added() || drift_.rows.empty()) return false;
  const Scalars& gaps = drift_.gaps[near].of_points;
  if (!search_.covers(near, gaps) || !search_.in_front(near, gaps, 0.5 * tolerance)) return false;
  known_ = near;
  return true;
}

/// Lists the samples that touch among all samples near the plane, if they have not been listed.
void SurfaceContact::list_touching() {
  touching_.clear();
  for (const int s : search_.near(known_)) {
    const double gap = drift_.gaps[known_].at(samples_, s);
    if (gap <= touching * length_) touching_.push_back({.row = {known_, s}, .gap = gap});
  }
  known_ = -1;
}

/// Does what `fit_known` does, for the closing.
bool SurfaceContact::find_stop_of_known(const StepView& step, const Points& v, const SurfaceRows& rows) {
  const HalfSpace& plane = end_[known_];
  if (!plane.spin.isZero(0)) return false;
  std::vector<Candidate>& known = close_.candidates;
  known.clear();
  const std::vector<int>& list = search_.near(known_);
  for (std::size_t t = 0; t < rows.close.size() && rows.close[t] >= 0; ++t) {
    const SurfaceRow row = row_of(rows.close[t]);
    if (row.plane == known_ && std::binary_search(list.begin(), list.end(), row.sample) &&
        drift_.gaps[known_].at(samples_, row.sample) <= touching * length_)
      known.push_back({.row = row});
  }
  return find_stop(known, step, v, rows) == StepStatus::ok && !close_.added() &&
         search_.in_front(known_, close_.gaps[known_].of_points, 0.5 * slack_ - plane.normal.dot(plane.velocity));
}

}  // namespace softffd
