#include "contact/implicit/surface_touches.hpp"

#include <algorithm>

#include "contact/tolerances.hpp"

namespace softffd {

namespace {

/// Turns of normal forces and friction; looks for samples until those that a solution has brought to a plane are among them.
constexpr int most_turns = 30, most_looks = 20;
/// Roundings of a place that friction's law may be missed by where it is looked for; a solution may not miss it by more than gaps.
constexpr double exact_roundings = 4;
/// Of the way that a force alone would move its sample, where others hold it: what is left of the sum is known no better.
constexpr double response_roundings = 2;

constexpr auto by_row = [](const auto& a, const auto& b) { return a.row < b.row; };

}  // namespace

SurfaceTouches::SurfaceTouches(const Samples& samples, double length, int planes)
    : samples_(samples),
      length_(length),
      middle_(planes),
      end_(planes),
      friction_(planes, 0.0),
      normals_(planes),
      search_(samples, planes, length),
      matrix_(samples.lattice()),
      set_(samples),
      feasible_(planes) {
  for (Points* each : {&solution_.change, &solution_.reaction, &free_, &move_}) each->setZero(samples.lattice().points(), 3);
}

void SurfaceTouches::open(const Step& step) {
  const Drive& around = step.equations.around;
  for (std::size_t q = 0; q < end_.size(); ++q) {
    middle_[q] = around.planes[q].at(step.t + 0.5 * step.h);
    end_[q] = around.planes[q].at(step.t + step.h);
    friction_[q] = around.planes[q].friction;
    normals_[q] = end_[q].normal;
  }
  set_.delassus().set_planes(normals_);
}

bool SurfaceTouches::possible(const Vec3& x, double slack) {
  std::vector<Constraint> constraints;
  for (const HalfSpace& plane : end_) constraints.push_back({.normal = plane.normal, .bound = plane.offset});
  Vec3 nearest = x;
  return feasible_.project(constraints, slack, nearest);
}

/// The forces of the step before.
void SurfaceTouches::guess(const Step& step, const Points&, const Points&) {
  const HeldRows& held = step.from.held_rows;
  const int count = samples_.count();
  forces_.clear();
  for (std::size_t t = 0; t < held.rows.size() && held.rows[t] >= 0; ++t) {
    const SurfaceRow row{int(held.rows[t] / count), int(held.rows[t] % count)};
    if (row.plane < int(end_.size()) && (forces_.empty() || forces_.back().row < row))  // a state may hold anything
      forces_.push_back({row, softffd::row(held.forces, int(t))});
  }
}

void SurfaceTouches::hold(State& state) const {
  HeldRows& held = state.held_rows;
  if (held.rows.empty()) {
    held.rows.resize(forces_.size());
    held.forces.resize(forces_.size(), 3);
  }
  held.forget();
  for (std::size_t t = 0; t < std::min(forces_.size(), held.rows.size()); ++t) {
    held.rows[t] = Count(forces_[t].row.plane) * samples_.count() + forces_[t].row.sample;
    set_row(held.forces, int(t), forces_[t].force);
  }
}

StepStatus SurfaceTouches::solve(const StepProblem& problem, bool) {
  solution_.fresh = solution_.settled = false;
  if (!solve_free(problem)) return StepStatus::not_finite;
  before_ = forces_;
  if (const StepStatus status = find_forces(problem); status != StepStatus::ok) return status;
  std::erase_if(forces_, [](const Force& each) { return each.force.isZero(0); });
  solution_.change = move_;
  matrix_.forces_of(problem, move_, solution_.reaction);
  solution_.reaction -= problem.residual;
  for (const Force& each : forces_) set_.delassus().spread(each.row.sample, -each.force, solution_.reaction);
  return StepStatus::ok;
}

/// The motion with the forces at hand.
bool SurfaceTouches::solve_free(const StepProblem& problem) {
  if (stale_) matrix_.linearise(problem);
  for (;;) {
    if (stale_) {
      matrix_.assemble(problem);
      matrix_.factor();
      set_.delassus().set_matrix(matrix_, problem.body);
      solution_.fresh = true;
      stale_ = false;
    }
    free_ = problem.residual;
    add_forces(free_);
    for (int p = 0; p < problem.body.points(); ++p)
      if (problem.body.pinned[p]) set_row(free_, p, Vec3::Zero());
    matrix_.solve(free_);
    if (std::isfinite(kernels::largest(free_.size(), free_.data()))) return true;
    if (!matrix_.soften(problem)) return false;
    stale_ = true;
  }
}

StepStatus SurfaceTouches::find_forces(const StepProblem& problem) {
  for (int turn = 0; turn < most_turns; ++turn) {
    bool lost = false;
    if (const StepStatus status = press(problem, lost); status != StepStatus::ok) return status;
    const bool found = rubs() ? rub(problem) : !lost;
    solution_.settled = found && doubt_ <= problem.slack;
    if (found) break;
  }
  return StepStatus::ok;
}

/// Normal forces beside the friction at hand, from the loads at hand on. lost: rows with friction touch no more.
StepStatus SurfaceTouches::press(const StepProblem& problem, bool& lost) {
  lost = false;
  for (int looks = 0; looks < most_looks; ++looks) {
    find_loads();
    find_move(forces_);
    find_heights(problem);
    if (looks == 0) all_covered();
    list_candidates();
    set_.delassus().set_rows(start_);
    if (const StepStatus status = set_.solve(candidates_, heights_, problem.slack, loads_); status != StepStatus::ok) return status;
    if (set_.pinned_violation() > pin_slack * length_) return StepStatus::pin_behind_plane;
    lost = take_loads() || lost;
    find_move(forces_);
    find_heights(problem);
    if (in_front(problem.slack)) return StepStatus::ok;
  }
  return StepStatus::not_finite;
}

/// Rows that press, and how much; what pulls is no load.
void SurfaceTouches::find_loads() {
  start_.clear();
  loads_.clear();
  for (Force& each : forces_) {
    const Vec3& normal = normals_[each.row.plane];
    const double load = normal.dot(each.force);
    if (load > 0) {
      start_.push_back(each.row);
      loads_.push_back(load);
    } else {
      each.force = tangential(normal, each.force);
    }
  }
}

/// Those of the active rows in the place of the ones at hand. Returns whether a row has lost friction with its load.
bool SurfaceTouches::take_loads() {
  active_.clear();
  for (std::size_t t = 0; t < set_.active().size(); ++t) {
    const SurfaceRow& row = set_.active()[t];
    const Vec3& normal = normals_[row.plane];
    active_.push_back({row, set_.forces()[t] * normal});
    const auto at = std::lower_bound(forces_.begin(), forces_.end(), active_.back(), by_row);
    if (at == forces_.end() || at->row != row) continue;
    active_.back().force += tangential(normal, at->force);
    at->force.setZero();
  }
  const bool lost = std::any_of(forces_.begin(), forces_.end(),
                                [&](const Force& each) { return !tangential(normals_[each.row.plane], each.force).isZero(0); });
  forces_.swap(active_);
  return lost;
}

bool SurfaceTouches::rubs() const {
  return std::any_of(forces_.begin(), forces_.end(), [&](const Force& each) { return friction_[each.row.plane] > 0; });
}

/// All forces of the active rows. Returns whether they keep to Coulomb's law, and the other rows in front of their planes.
bool SurfaceTouches::rub(const StepProblem& problem) {
  StepDelassus& g = set_.delassus();
  const int n = int(forces_.size());
  coulomb_.normals.clear();
  coulomb_.friction.clear();
  coulomb_.g.clear();
  coulomb_.u.clear();
  std::vector<Vec3> force;
  for (const Force& each : forces_) {
    coulomb_.normals.push_back(normals_[each.row.plane]);
    coulomb_.friction.push_back(friction_[each.row.plane]);
    coulomb_.u.push_back(place(problem, each.row));
    force.push_back(each.force);
    for (int t = 0; t < n; ++t) coulomb_.g.push_back(g(each.row.sample, forces_[t].row.sample));
  }
  coulomb_.exact = exact_roundings * rounding / position_slack * problem.slack + doubt_;
  const double missed = rows_.solve(coulomb_, force);
  for (int t = 0; t < n; ++t) forces_[t].force = force[t];
  find_move(forces_);
  find_heights(problem);
  return missed <= problem.slack + doubt_ && in_front(problem.slack);
}

/// Are the samples in front of the planes at the heights at hand, as far as their lists and rounding let know? Looks for them anew where
/// the lists do not do.
bool SurfaceTouches::in_front(double slack) {
  const bool covered = all_covered();
  list_candidates();
  return covered && std::all_of(candidates_.begin(), candidates_.end(), [&](const Candidate& each) {
           const int s = each.row.sample;
           return heights_[each.row.plane].at(samples_, s) >= -2 * slack - doubt_ ||
                  set_.delassus()(s, s).isZero(0);  // all of it pinned
         });
}

/// What a row has of gap along its normal and of slip across it [m].
Vec3 SurfaceTouches::place(const StepProblem& problem, const SurfaceRow& row) const {
  const HalfSpace& plane = end_[row.plane];
  const Vec3 begin = samples_.at(row.sample, problem.x0), u = samples_.at(row.sample, problem.u), move = samples_.at(row.sample, move_);
  const Vec3 slip = u + move - problem.h * material_velocity(row.plane, begin + 0.5 * u);
  return (plane.gap(samples_.at(row.sample, problem.x)) + plane.normal.dot(move)) * plane.normal + tangential(plane.normal, slip);
}

/// With these forces in the place of those before.
void SurfaceTouches::find_move(const std::vector<Force>& forces) {
  move_ = free_;
  doubt_ = 0;
  StepDelassus& g = set_.delassus();
  const auto push = [&](int s, const Vec3& more) {
    g.add_response(s, more, move_);
    doubt_ += response_roundings * rounding * more.norm() * g(s, s).trace();
  };
  std::size_t t = 0;
  for (const Force& was : before_) {
    for (; t < forces.size() && forces[t].row < was.row; ++t) push(forces[t].row.sample, forces[t].force);
    const bool both = t < forces.size() && forces[t].row == was.row;
    push(was.row.sample, (both ? forces[t++].force : Vec3(Vec3::Zero())) - was.force);
  }
  for (; t < forces.size(); ++t) push(forces[t].row.sample, forces[t].force);
}

/// Of the control points above the planes, moved.
void SurfaceTouches::find_heights(const StepProblem& problem) {
  heights_.resize(end_.size());
  for (std::size_t q = 0; q < end_.size(); ++q) {
    Scalars& heights = heights_[q].of_points;
    heights = Scalars::Constant(move_.rows(), -end_[q].offset);
    for (int axis = 0; axis < 3; ++axis) heights += normals_[q][axis] * (problem.x.col(axis) + move_.col(axis));
  }
}

/// Samples near the planes, and loaded ones.
void SurfaceTouches::list_candidates() {
  candidates_.clear();
  for (int q = 0; q < int(end_.size()); ++q)
    for (const int s : search_.near(q)) candidates_.push_back({.row = {q, s}});
  const std::size_t near = candidates_.size();
  for (const SurfaceRow& row : start_)
    if (!std::binary_search(candidates_.begin(), candidates_.begin() + near, Candidate{.row = row}, by_row))
      candidates_.push_back({.row = row});
  std::inplace_merge(candidates_.begin(), candidates_.begin() + near, candidates_.end(), by_row);
}

/// Looks for samples anew where their lists do not do; returns whether all did.
bool SurfaceTouches::all_covered() {
  bool covered = true;
  for (std::size_t q = 0; q < end_.size(); ++q)
    if (!search_.covers(int(q), heights_[q].of_points)) {
      search_.look(int(q), heights_[q].of_points, move_.abs().maxCoeff());
      covered = false;
    }
  return covered;
}

void SurfaceTouches::add_forces(Points& f) const {
  for (const Force& each : forces_) set_.delassus().spread(each.row.sample, each.force, f);
}

double SurfaceTouches::largest_load() const {
  double largest = 0;
  for (const Force& each : forces_) largest = std::max(largest, normals_[each.row.plane].dot(each.force));
  return largest;
}

void SurfaceTouches::find_reactions(std::vector<Reaction>& reactions) const {
  reactions.clear();
  for (const Force& each : forces_) reactions.push_back({each.row.plane, each.row.sample, normals_[each.row.plane], each.force, true});
}

}  // namespace softffd
