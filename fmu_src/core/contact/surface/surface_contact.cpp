#include "contact/surface/surface_contact.hpp"

#include <algorithm>

#include "contact/free/free_parts.hpp"
#include "contact/surface/surface_loops.hpp"
#include "contact/tolerances.hpp"

namespace softffd {

namespace {

/// Largest number of times that a stage is solved with new samples, until the samples that it has brought to a plane are among them.
constexpr int most_looks = 20;
/// Largest number of times that supporting half-spaces are lifted because a free obstacle turns.
constexpr int most_lifts = 5;
/// A gain of kinetic energy up to this fraction of the energy that contact exchanges counts as rounding.
constexpr double no_gain = 1e-10;
/// Friction of the state above this multiple of the Coulomb limit is not used as a warm start.
constexpr double most_fraction = 2;

}  // namespace

/// Takes over rows of the state. Only rows among the candidates can be active.
void SurfaceContact::load(const std::vector<Count>& numbers, const Points& friction, SurfaceStage& stage) const {
  stage.rows.clear();
  stage.fraction.clear();
  auto at = stage.candidates.begin();
  for (std::size_t t = 0; t < numbers.size() && numbers[t] >= 0; ++t) {
    while (at != stage.candidates.end() && number(at->row) < numbers[t]) ++at;
    if (at == stage.candidates.end()) return;
    if (number(at->row) != numbers[t]) continue;
    stage.rows.push_back(at->row);
    const Vec3 fraction = softffd::row(friction, int(t));
    stage.fraction.push_back(fraction.norm() <= most_fraction ? fraction : Vec3(Vec3::Zero()));  // a state may hold anything
    ++at;
  }
}

void SurfaceContact::save(const SurfaceStage& stage, std::vector<Count>& numbers, Points& friction) const {
  const std::size_t known = std::min(numbers.size(), stage.rows.size());
  for (std::size_t t = 0; t < known; ++t) {
    numbers[t] = number(stage.rows[t]);
    set_row(friction, int(t), stage.fraction[t]);
  }
  for (std::size_t t = known; t < numbers.size() && numbers[t] >= 0; ++t) {
    numbers[t] = -1;
    set_row(friction, int(t), Vec3::Zero());
  }
}

SurfaceContact::SurfaceContact(const Body& body, int planes)
    : samples_(*body.samples),
      length_(body.length),
      search_(samples_, planes, length_),
      tangents_(samples_, length_),
      drift_(samples_),
      close_(samples_),
      free_rows_(samples_),
      still_(planes, 0),
      at_hand_(samples_),
      behind_(body.points() / 8 + 1) {
  in_evaluation_ = Operations::in_evaluation(body.points());
}

void SurfaceContact::set_planes() {
  normals_.clear();
  for (const HalfSpace& plane : end_) normals_.push_back(plane.normal);
  drift_.set_planes(normals_, friction_, alone_);
  close_.set_planes(normals_, friction_, alone_);
}

void SurfaceContact::begin(const Body& body, const HalfKicks& kicks, const Drive& around, double t0, double h) {
  drift_.begin();
  close_.begin();
  if (call_ != around.call) search_.forget();
  call_ = around.call;
  if (h != h_ || body.version != version_) {
    h_ = h;
    version_ = body.version;
    const auto inverse = [&](const Scalars& mass) { return Scalars(body.inverse_mass.head(body.points()) * body.mass / mass); };
    drift_.set_masses(inverse(kicks.opening_mass()));
    close_.set_masses(inverse(kicks.closing_mass()));
  }
  know(around, t0);
  holds_ = false;
}

void SurfaceContact::move_planes(const StepView& step) {
  bool moved = false;
  for (int q = 0; q < flat_; ++q) {
    if (still_[q]) continue;
    const Plane& plane = step.around.planes[q];
    start_[q] = plane.at(step.t0);
    middle_[q] = plane.at(0.5 * (step.t0 + step.t1));
    end_[q] = plane.at(step.t1);
    if (!poses_.empty()) poses_[q] = plane.pose_at(step.t1);
    moved = true;
  }
  if (moved) set_planes();
}

/// Computes the gaps above the planes. Returns whether a control point, or the sample of a supporting half-space, is behind one.
bool SurfaceContact::find_gaps(const Points& x1) {
  bool behind = false;
  for (std::size_t q = 0; q < end_.size(); ++q) {
    GapFunction& gap = drift_.gaps[q];
    if (alone_[q] < samples_.count()) {
      behind = gap.find(samples_, x1, end_[q].normal, end_[q].offset) || behind;
    } else {
      gap.of_sample = end_[q].gap(tangents_.found()[q - flat_].nearest);
      behind = behind || gap.of_sample < 0;
    }
  }
  return behind;
}

/// Computes the velocities along the normals at the end of the step, except for plane `but`.
void SurfaceContact::find_speeds(const Points& v, int but) {
  for (int q = 0; q < int(end_.size()); ++q) {
    if (q == but) continue;
    if (alone_[q] < samples_.count())
      close_.gaps[q].find(samples_, v, end_[q].normal, 0);
    else
      close_.gaps[q].of_sample = end_[q].normal.dot(tangents_.found()[q - flat_].velocity);
  }
}

/// Lists the samples near plane q.
void SurfaceContact::search(int q, const Scalars& gaps, double way) {
  search_.look(q, gaps, way);
  found_ += Operations::of_value * samples_.count();
}

double SurfaceContact::slack_of_rows() const {
  double far = length_;
  for (const HalfSpace& plane : end_) far = std::max(far, length_ + std::abs(plane.offset));
  return row_slack * far;
}

/// Solves for the samples near the planes, and again if the solution has brought other samples there. rows: of the state; way: by how
/// much a point moves [m].
StepStatus SurfaceContact::fit(const std::vector<Count>& rows, const Points& friction, double way, const Slip& slip) {
  free_ = drift_.gaps;
  for (int q = 0; q < flat_; ++q)
    if (!search_.covers(q, free_[q].of_points)) search(q, free_[q].of_points, way);
  const double tolerance = slack_of_rows();
  if (fit_known(rows, friction, tolerance, slip)) return StepStatus::ok;
  for (int looks = 0; looks < most_looks; ++looks) {
    drift_.gaps = free_;
    drift_.candidates.clear();
    for (int q = 0; q < flat_; ++q)
      for (const int s : search_.near(q)) drift_.candidates.push_back({.row = {q, s}});
    for (const Tangent& each : tangents_.found())
      drift_.candidates.push_back({.row = {flat_ + int(&each - tangents_.found().data()), each.sample}});
    load(rows, friction, drift_);
    if (const StepStatus status = drift_.solve(tolerance, slip); status != StepStatus::ok) return status;
    bool covered = true;
    for (int q = 0; q < flat_; ++q)
      if (!search_.covers(q, drift_.gaps[q].of_points)) {
        search(q, drift_.gaps[q].of_points, way);
        covered = false;
      }
    if (covered) return drift_.pinned_violation() > pin_slack * length_ ? StepStatus::pin_behind_plane : StepStatus::ok;
  }
  return StepStatus::not_finite;
}

/// Returns where a sample should be tangentially at the end of the drift: it sticks from the moment at which it reaches its plane.
Vec3 SurfaceContact::aim(const StepView& step, const Vec3& free, const SurfaceRow& row, bool at_once) {
  const Vec3 begin = begin_of(row, step.x0);
  const Vec3 target = begin + step.h * middle_[row.plane].material_velocity(0.5 * (begin + free));
  const double gap = start_[row.plane].gap(begin);
  if (at_once || gap <= touching * length_) return target;
  arrives_ = true;
  const double left = end_[row.plane].gap(free), fraction = left < 0 ? gap / (gap - left) : 1;
  return target + fraction * tangential(end_[row.plane].normal, free - target);
}

void SurfaceContact::find(const StepView& step, const Points& x1, const SurfaceRows& rows) {
  move_planes(step);
  if (solids_) find_tangents(step.around, step.t0, step.t1, step.x0, tangents_.way(step.x0, x1));
  bool any = rows.drift[0] >= 0 || near_ || int(end_.size()) > flat_;
  if (!any) {  // costs less than computing gaps
    const Points& hull = samples_.hull(x1, room_);
    for (int q = 0; q < flat_ && !any; ++q)
      any = kernels::behind(step.body.points(), hull.data(), end_[q].normal.data(), end_[q].offset, behind_.data());
  }
  near_ = (any && find_gaps(x1)) || rows.drift[0] >= 0;
}

StepStatus SurfaceContact::drift(const StepView& step, const Points& before, Points& v, Points& x1, SurfaceRows& rows,
                                 std::vector<FreeState>& free, Exchange& exchange) {
  touching_.clear();
  known_ = -1;
  places_known_ = false;
  free_start_ = free;
  set_free(step.around, free_start_, step.x0);
  pins_.begin(step.around, before);
  if (near_) {
    divide_work(drift_);
    places_known_ = drift_.free() ? warm_start_free_drift(step, x1, rows) : warm_start_drift(step, v, x1, rows);
    StepStatus status = places_known_ ? StepStatus::ok : position_stage(step, v, x1, rows);
    for (int turns = 0; turns < most_lifts && status == StepStatus::ok && lift_tangents(step, x1, free); ++turns) {
      places_known_ = false;
      touching_.clear();
      find_gaps(x1);
      status = position_stage(step, v, x1, rows);
    }
    if (status != StepStatus::ok) return status;
    if (!drift_.rows.empty()) {
      drift_.give(1 / step.h, v, &x1);
      exchange.contacts_resolved += Count(drift_.rows.size());
      if (!places_known_) find_places(drift_, x1);
      places_known_ = true;
      if (const StepStatus status = pressed_solids(step, drift_); status != StepStatus::ok) return status;
      exchange.dissipated += book(step, drift_, 1 / step.h, exchange);
    }
    fly(step, free);
    give_free(drift_, step.around, 1 / step.h, true, free);
    rows.missed = std::max(rows.missed, drift_.missed());
    save(drift_, rows.drift, rows.drift_friction);
  } else {
    fly(step, free);
  }
  if (holds_)
    std::erase_if(lasting_, [&, at = touching_.begin()](const Candidate& candidate) mutable {
      while (at != touching_.end() && at->row < candidate.row) ++at;
      return at == touching_.end() || at->row != candidate.row;
    });
  if (touching_.empty()) {
    close_.rows.clear();
    save(close_, rows.close, rows.close_friction);
  } else {
    if (solids_) turn_tangents(step, x1);
    if (wants_loss(step)) {
      start_v_ = before;
      if (lands_) start_force_ = step.spring + step.force;
    }
  }
  return StepStatus::ok;
}

void SurfaceContact::allow(double most) {
  most_ = most;
  found_ = 0;
  for (SurfaceStage* stage : {&drift_, &close_}) stage->operations().allow(most * in_evaluation_);
}

/// Limits the work of a stage that begins to what the other stage and the searches have left.
void SurfaceContact::divide_work(SurfaceStage& stage) {
  const SurfaceStage& other = &stage == &drift_ ? close_ : drift_;
  stage.operations().limit(most_ * in_evaluation_ - found_ - other.operations().done());
}

double SurfaceContact::work() const { return (found_ + drift_.operations().done() + close_.operations().done()) / in_evaluation_; }

/// Solves the drift's stage, and again while its result may have brought other samples to a solid.
StepStatus SurfaceContact::position_stage(const StepView& step, const Points& v, const Points& x1, const SurfaceRows& rows) {
  StepStatus status = solve_near(step, v, x1, rows);
  for (int looks = 0; solids_ && status == StepStatus::ok; ++looks) {
    const double whole = tangents_.way(step.x0, x1 + drift_.move()) + obstacles_way(step.around);
    if (tangents_.covers(whole)) break;
    if (looks == most_looks || spent()) return StepStatus::not_finite;
    find_tangents(step.around, step.t0, step.t1, step.x0, 2 * whole);
    find_gaps(x1);
    status = solve_near(step, v, x1, rows);
  }
  if (status != StepStatus::ok) return status;
  std::size_t known = 0;
  const Count before = impacts_;
  const bool flew = drift_.free() && rows.drift[0] < 0;
  for (const SurfaceRow& row : drift_.rows) {
    const Count own = number(row);
    while (known < rows.drift.size() && rows.drift[known] >= 0 && rows.drift[known] < own) ++known;
    if (known < rows.drift.size() && rows.drift[known] == own) continue;
    impacts_ += flew || start_[row.plane].gap(begin_of(row, step.x0)) > touching * length_;
  }
  lands_ = impacts_ > before;
  for (const Candidate& candidate : drift_.candidates)
    if (candidate.gap <= touching * length_) touching_.push_back(candidate);
  return StepStatus::ok;
}

/// Solves the drift's stage with the current supporting half-spaces.
StepStatus SurfaceContact::solve_near(const StepView& step, const Points& v, const Points& x1, const SurfaceRows& rows) {
  const double way = step.h * largest_speed(v);
  arrives_ = false;
  for (const bool at_once : {false, true}) {
    const auto slip_of = [&](const SurfaceRow& row) {
      const Vec3 free = flown_of(row, x1);
      return Vec3(free - aim(step, free, row, at_once));
    };
    if (at_once) drift_.gaps = free_;
    if (const StepStatus status = fit(rows.drift, rows.drift_friction, way, std::ref(slip_of)); status != StepStatus::ok) return status;
    if (!arrives_ || !gains(step, x1)) break;
  }
  return StepStatus::ok;
}

/// True if the forces of the drift would add kinetic energy, in the frame of the planes.
bool SurfaceContact::gains(const StepView& step, const Points& x1) const {
  double gain = 0, size = 0;
  for (std::size_t t = 0; t < drift_.rows.size(); ++t) {
    const SurfaceRow& row = drift_.rows[t];
    const Vec3 begin = begin_of(row, step.x0), end = flown_of(row, x1);
    Vec3 by = 0.5 * samples_.at(row.sample, drift_.move());
    if (drift_.free()) by += 0.5 * drift_.free()->parting(row);
    const double each = drift_.force(int(t)).dot(end + by - begin - step.h * middle_[row.plane].material_velocity(0.5 * (begin + end)));
    gain += each;
    size += std::abs(each);
  }
  return gain > no_gain * size;
}

/// Changes the velocities after the closing kick so that these samples stay in front of their planes.
StepStatus SurfaceContact::stop(const std::vector<Candidate>& candidates, const StepView& step, Points& v, const SurfaceRows& rows) {
  places_known_ = false;
  const bool held = recall(rows.close, close_) && warm_start_close(step, v, candidates);
  const StepStatus status = held ? StepStatus::ok : find_stop(candidates, step, v, rows);
  if (status == StepStatus::ok) close_.give(1, v);
  return status;
}

StepStatus SurfaceContact::find_stop(const std::vector<Candidate>& candidates, const StepView& step, const Points& v,
                                     const SurfaceRows& rows) {
  const Points& x1 = step.x0;  // at this end of the step
  if (&candidates != &close_.candidates) close_.candidates = candidates;
  double fastest = largest_speed(v);
  for (Candidate& candidate : close_.candidates) {
    const HalfSpace& plane = end_[candidate.row.plane];
    const bool turns = !plane.spin.isZero(0);
    candidate.bound = plane.normal.dot(turns ? plane.material_velocity(begin_of(candidate.row, x1)) : plane.velocity);
    fastest = std::max(fastest, std::abs(candidate.bound));
    if (own(candidate.row)) fastest = std::max(fastest, tangent_of(candidate.row).velocity.norm());
  }
  find_speeds(v);
  load(rows.close, rows.close_friction, close_);
  const auto slip_of = [&](const SurfaceRow& row) {
    const HalfSpace& plane = end_[row.plane];
    const bool turns = !plane.spin.isZero(0);
    return Vec3(velocity_of(row, v) - (turns ? plane.material_velocity(begin_of(row, x1)) : plane.velocity));
  };
  slack_ = row_slack * fastest;
  return close_.solve(slack_, std::ref(slip_of));
}

/// True if the drift's rows are on one plane, were on it before the step, and at least one of them sticks.
bool SurfaceContact::sticks() const {
  const std::vector<SurfaceRow>& rows = drift_.rows;
  return !rows.empty() && !lands_ && rows.front().plane == rows.back().plane &&
         std::ranges::any_of(drift_.fraction, [](const Vec3& fraction) { return fraction.norm() < slid; });
}

StepStatus SurfaceContact::close(const StepView& step, Points& v, SurfaceRows& rows, std::vector<FreeState>& free, Exchange& exchange) {
  if (touching_.empty()) return StepStatus::ok;
  divide_work(close_);
  const std::vector<FreeState> before = free;
  set_free(step.around, before, step.x0);
  if (holds_) lasting_ = touching_;
  close_.rows = drift_.rows;
  if (close_.free() ? warm_start_free_close(step, v) : warm_start_close(step, v, touching_)) {
    if (!close_.free() && !places_known_) at_hand_.at(step.x0, places_);
  } else {
    if (sticks()) {  // others would carry the body as well, but friction on them would not hold what these hold
      close_.rows = drift_.rows;
      close_.fraction = drift_.fraction;
      save(close_, rows.close, rows.close_friction);
    }
    if (known_ < 0 || !find_stop_of_known(step, v, rows)) {
      if (known_ >= 0) list_touching();
      if (const StepStatus status = find_stop(touching_, step, v, rows); status != StepStatus::ok) return status;
    }
    find_places(close_, step.x0);
  }
  if (const StepStatus status = pressed_solids(step, close_); status != StepStatus::ok) return status;
  const bool touched = !drift_.rows.empty() || (!rows.close.empty() && rows.close[0] >= 0);
  if (!touched) impacts_ += Count(close_.rows.size());  // the drift ended on an obstacle, behind none
  close_.give(1, v);
  exchange.dissipated += book(step, close_, 1, exchange);
  give_free(close_, step.around, 1, false, free);
  book_free(step, free, exchange);
  exchange.dissipated += pins_.book(step.around, v, exchange);
  rows.missed = std::max(rows.missed, close_.missed());
  save(close_, rows.close, rows.close_friction);
  return StepStatus::ok;
}

}  // namespace softffd
