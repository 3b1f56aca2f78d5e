#include "contact/implicit/surface_touches.hpp"

#include <algorithm>

#include "contact/tolerances.hpp"

namespace softffd {

namespace {

/// Largest number of alternations between normal forces and friction; largest number of searches for samples until the lists hold all that
/// a solution has brought to a plane.
constexpr int most_turns = 30, most_looks = 20;
/// Roundings of a place by which the search for forces may miss Coulomb's law [1]; a solution may miss it by no more than gaps.
constexpr double exact_roundings = 4;
/// Error of a sample's motion, in roundings of the way that each force alone would move the sample [1]. Where other forces hold the
/// sample, the small sum is known no better.
constexpr double response_roundings = 2;

/// Turn of a free obstacle, beyond the pose in which it was placed, above which the solution is repeated [rad]. Samples are behind the
/// obstacle by the square of the turn.
constexpr double most_free_turn = 1e-7;

constexpr auto by_row = [](const auto& a, const auto& b) { return a.row < b.row; };

}  // namespace

SurfaceTouches::SurfaceTouches(const Samples& samples, double length, int planes)
    : samples_(samples),
      length_(length),
      seen_(planes),
      end_(planes),
      poses_(planes),
      free_rows_(samples),
      tangents_(samples, length),
      search_(samples, planes, length),
      matrix_(samples.lattice()),
      set_(samples),
      feasible_(planes) {
  for (Points* each : {&solution_.change, &solution_.reaction, &free_, &move_}) each->setZero(samples.lattice().points(), 3);
}

void SurfaceTouches::open(const Step& step) {
  step_ = &step;
  search_.forget();
  const std::vector<Plane>& obstacles = step.equations.around.planes;
  flat_ = int(std::ranges::count_if(obstacles, [](const Plane& each) { return !each.solid(); }));
  planes_.resize(flat_);
  obstacle_.resize(flat_);
  friction_.resize(flat_);
  own_.assign(flat_, Vec3::Zero());
  for (std::size_t q = 0; q < end_.size(); ++q) {
    seen_[q] = obstacles[q].at(step.t + step.seen * step.h);
    end_[q] = obstacles[q].at(step.t + step.h);
    poses_[q] = obstacles[q].pose_at(step.t + step.h);
  }
  for (int q = 0; q < flat_; ++q) {
    planes_[q] = end_[q];
    obstacle_[q] = q;
    friction_[q] = obstacles[q].friction;
  }
  forces_.clear();
  set_normals();
  if (!step.equations.around.free.empty()) place_free(step.from.x);
}

void SurfaceTouches::set_normals() {
  normals_.clear();
  for (const HalfSpace& plane : planes_) normals_.push_back(plane.normal);
  set_.delassus().set_planes(normals_);
}

/// Solids are not considered, because there is room beside them.
bool SurfaceTouches::possible(const Vec3& x, double slack) {
  std::vector<Constraint> constraints;
  for (int q = 0; q < flat_; ++q) constraints.push_back({.normal = planes_[q].normal, .bound = planes_[q].offset});
  Vec3 nearest = x;
  return feasible_.project(constraints, slack, nearest);
}

/// Begins with the forces of the step before.
void SurfaceTouches::guess(const Step& step, const Points&, const Points& x) {
  if (flat_ < int(end_.size())) find_tangents(tangents_.way(step.from.x, x));
  const HeldRows& held = step.from.held_rows;
  const int count = samples_.all();
  forces_.clear();
  for (std::size_t t = 0; t < held.rows.size() && held.rows[t] >= 0; ++t) {
    const int obstacle = int(held.rows[t] / count), sample = int(held.rows[t] % count);
    if (obstacle >= int(end_.size())) break;  // a state may hold anything
    const SurfaceRow row{plane_of(obstacle, sample), sample};
    if (row.plane >= 0 && (forces_.empty() || forces_.back().row < row)) forces_.push_back({row, softffd::row(held.forces, int(t))});
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
    held.rows[t] = number(forces_[t].row);
    set_row(held.forces, int(t), forces_[t].force);
  }
}

StepStatus SurfaceTouches::solve(const StepProblem& problem, bool) {
  solution_.fresh = solution_.settled = solution_.again = false;
  const bool solids = flat_ < int(end_.size());
  if (!free_bodies_.empty()) place_free(problem.x);
  if (solids && !covered_) find_tangents(2 * std::max(tangents_.way(problem.x0, problem.x), way_of_free()));
  if (solids) turn_tangents(problem);
  find_lack();
  if (!solve_free(problem)) return StepStatus::not_finite;
  before_ = forces_;
  if (const StepStatus status = find_forces(problem); status != StepStatus::ok) return status;
  std::erase_if(forces_, [](const Force& each) { return each.force.isZero(0); });
  if (solids) {
    covered_ = tangents_.covers(std::max(tangents_.way(problem.x0, problem.x + move_), way_of_free()));
    solution_.again = !covered_ || !tangents_stand(problem);
    for (const Twist& each : free_rows_.twists()) solution_.again = solution_.again || each.turn.norm() > most_free_turn;
  }
  solution_.change = move_;
  matrix_.forces_of(problem, move_, solution_.reaction);
  solution_.reaction -= problem.residual;
  for (const Force& each : forces_) set_.delassus().spread(each.row.sample, -each.force, solution_.reaction);
  return StepStatus::ok;
}

void SurfaceTouches::refresh() {
  stale_ = true;
  resumed_ = false;
  if (step_->kept) step_->kept->h = 0;
}

/// The result follows, to the bit, from the kept matrix alone, in this instance or another. That does not hold with parts of free pins.
bool SurfaceTouches::resume(const Step& step) {
  const auto parts = [](const FreeMotion& each) { return each.part(); };
  if (step.kept->x->rows() == 0 || std::ranges::any_of(step.equations.around.free, parts)) return false;
  stale_ = resumed_ = made_.h != step.kept->h || made_.x.mark() != step.kept->x.mark();
  if (!stale_) set_.delassus().forget_many();
  return true;
}

/// Linearises at the present state, or at that of the kept matrix.
void SurfaceTouches::linearise(const StepProblem& problem) {
  Factored* kept = step_->kept;
  if (resumed_) {
    made_ = *kept;
  } else {
    made_.x.change() = problem.x;
    made_.h = problem.h;
    if (kept && kept->x->rows() > 0) *kept = made_;
  }
  const double h = made_.h;
  matrix_.linearise(*made_.x, problem.body.mass / (h * h) + problem.body.damping / h, h);
}

/// Computes the motion with the present forces.
bool SurfaceTouches::solve_free(const StepProblem& problem) {
  if (stale_) linearise(problem);
  for (;;) {
    if (stale_) {
      matrix_.assemble(problem.body);
      matrix_.factor(problem, !resumed_);
      set_.delassus().set_matrix(matrix_, problem.body);
      solution_.fresh = !resumed_;
      stale_ = false;
    }
    free_ = problem.residual;
    add_forces(free_);
    problem.body.hold_prescribed(free_);
    matrix_.solve_residual(problem, free_);
    if (std::isfinite(kernels::largest(free_.size(), free_.data()))) {
      resumed_ = false;
      return true;
    }
    refresh();
    made_ = {};
    if (!matrix_.soften()) return false;
  }
}

StepStatus SurfaceTouches::find_forces(const StepProblem& problem) {
  std::vector<int> loaded;
  for (const Force& each : forces_) loaded.push_back(each.row.sample);
  set_.delassus().respond(loaded);
  for (int turn = 0; turn < most_turns && !operations().spent(); ++turn) {
    bool lost = false;
    if (const StepStatus status = solve_normal_forces(problem, lost); status != StepStatus::ok) return status;
    const bool found = has_friction() ? solve_friction(problem) : !lost;
    solution_.settled = found && doubt_ <= problem.slack;
    if (found) break;
  }
  return StepStatus::ok;
}

/// Finds the normal forces beside the present friction, starting from the present loads. lost: constraints with friction touch no more.
StepStatus SurfaceTouches::solve_normal_forces(const StepProblem& problem, bool& lost) {
  lost = false;
  for (int looks = 0; looks < most_looks; ++looks) {
    find_loads();
    find_move(forces_);
    find_gaps(problem);
    if (looks == 0) all_covered();
    list_candidates();
    set_.delassus().set_rows(start_);
    if (const StepStatus status = set_.solve(candidates_, gap_functions_, problem.slack, loads_); status != StepStatus::ok) return status;
    if (set_.pinned_violation() > pin_slack * length_) return StepStatus::pin_behind_plane;
    lost = take_loads() || lost;
    find_move(forces_);
    find_gaps(problem);
    if (in_front(problem.slack)) return StepStatus::ok;
  }
  return StepStatus::not_finite;
}

/// Lists the contact constraints that press, with their loads. A pulling force is no load and is removed.
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

/// Replaces the forces by those of the active constraints. Returns whether a constraint has lost its friction together with its load.
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

bool SurfaceTouches::has_friction() const {
  return std::any_of(forces_.begin(), forces_.end(), [&](const Force& each) { return friction_[each.row.plane] > 0; });
}

/// Finds all forces of the active contact constraints. Returns whether they obey Coulomb's law and keep the other samples in front.
bool SurfaceTouches::solve_friction(const StepProblem& problem) {
  StepDelassus& g = set_.delassus();
  const int n = int(forces_.size());
  g.operations().spend(n * (4 * Operations::of_place + 20.0 * n));
  coulomb_.normals.clear();
  coulomb_.friction.clear();
  coulomb_.g.clear();
  coulomb_.u.clear();
  std::vector<Vec3> force;
  for (const Force& each : forces_) {
    coulomb_.normals.push_back(normals_[each.row.plane]);
    coulomb_.friction.push_back(friction_[each.row.plane]);
    coulomb_.u.push_back(place(problem, each.row));
    if (own(each.row)) coulomb_.u.back() += g.give(each.row) * tangential(normals_[each.row.plane], each.force);
    force.push_back(each.force);
    for (int t = 0; t < n; ++t) coulomb_.g.push_back(g.block(each.row, forces_[t].row));
  }
  coulomb_.exact = exact_roundings * rounding / position_slack * problem.slack + doubt_;
  const double missed = rows_.solve(coulomb_, g.operations(), force);
  for (int t = 0; t < n; ++t) forces_[t].force = force[t];
  find_move(forces_);
  find_gaps(problem);
  return missed <= problem.slack + doubt_ && in_front(problem.slack);
}

/// True if the samples are in front of the planes at the present gaps, as far as their lists and rounding can tell. Searches anew where
/// the lists are not sufficient.
bool SurfaceTouches::in_front(double slack) {
  const bool covered = all_covered();
  list_candidates();
  operations().spend(Operations::of_value * double(candidates_.size()));
  return covered && std::all_of(candidates_.begin(), candidates_.end(), [&](const Candidate& each) {
           const int s = each.row.sample;
           return gap_functions_[each.row.plane].at(samples_, s) >= -2 * slack - doubt_ ||
                  set_.delassus().block(each.row, each.row).isZero(0);  // all its points are pinned
         });
}

/// Gap of a contact constraint along its normal, plus its slip across the normal [m].
Vec3 SurfaceTouches::place(const StepProblem& problem, const SurfaceRow& row) const {
  const HalfSpace& plane = planes_[row.plane];
  const Vec3 begin = begin_of(row), u = own(row) ? Vec3(material_of(row, problem.x) - begin) : samples_.at(row.sample, problem.u);
  Vec3 move = samples_.at(row.sample, move_);
  if (free_rows_.any()) move += free_rows_.parting(row);
  const Vec3 slip = u + move - problem.h * material_velocity(obstacle_[row.plane], begin + step_->seen * u);
  return (plane.gap(sample_of_row(row, problem.x).place) + plane.normal.dot(move)) * plane.normal + tangential(plane.normal, slip);
}

/// Computes the motion with these forces in place of those before, and its rounding error.
void SurfaceTouches::find_move(const std::vector<Force>& forces) {
  move_ = free_;
  doubt_ = 0;
  StepDelassus& g = set_.delassus();
  if (free_rows_.any()) free_rows_.set_given(lack_);
  const auto push = [&](const SurfaceRow& row, const Vec3& more) {
    g.add_response(row.sample, more, move_);
    if (free_rows_.any()) free_rows_.add_force(row, more);
    doubt_ += response_roundings * rounding * more.norm() * g.block(row, row).trace();
  };
  std::size_t t = 0;
  for (const Force& was : before_) {
    for (; t < forces.size() && forces[t].row < was.row; ++t) push(forces[t].row, forces[t].force);
    const bool both = t < forces.size() && forces[t].row == was.row;
    push(was.row, (both ? forces[t++].force : Vec3(Vec3::Zero())) - was.force);
  }
  for (; t < forces.size(); ++t) push(forces[t].row, forces[t].force);
}

/// Computes the gap functions of the planes after the motion.
void SurfaceTouches::find_gaps(const StepProblem& problem) {
  gap_functions_.resize(planes_.size());
  operations().spend(6.0 * flat_ * double(move_.rows()) + 2 * Operations::of_place * double(planes_.size() - flat_));
  for (int q = 0; q < int(planes_.size()); ++q) {
    const HalfSpace& plane = planes_[q];
    gap_functions_[q].sample = q < flat_ ? -1 : tangents_.found()[q - flat_].sample;
    if (const int s = gap_functions_[q].sample; s >= 0) {
      gap_functions_[q].of_sample = plane.gap(sample_of_row({q, s}, problem.x).place) + plane.normal.dot(samples_.at(s, move_));
      if (free_rows_.any()) gap_functions_[q].of_sample += plane.normal.dot(free_rows_.parting({q, s}));
      continue;
    }
    Scalars& gaps = gap_functions_[q].of_points;
    gaps = Scalars::Constant(move_.rows(), -plane.offset);
    for (int axis = 0; axis < 3; ++axis) gaps += plane.normal[axis] * (problem.x.col(axis) + move_.col(axis));
  }
}

/// Lists the samples near the planes and the loaded ones.
void SurfaceTouches::list_candidates() {
  candidates_.clear();
  for (int q = 0; q < flat_; ++q)
    for (const int s : search_.near(q)) candidates_.push_back({.row = {q, s}});
  for (int q = flat_; q < int(planes_.size()); ++q) candidates_.push_back({.row = {q, gap_functions_[q].sample}});
  const std::size_t near = candidates_.size();
  for (const SurfaceRow& row : start_)
    if (!std::binary_search(candidates_.begin(), candidates_.begin() + near, Candidate{.row = row}, by_row))
      candidates_.push_back({.row = row});
  std::inplace_merge(candidates_.begin(), candidates_.begin() + near, candidates_.end(), by_row);
}

/// Searches for samples anew where their lists are not sufficient. Returns whether all lists were.
bool SurfaceTouches::all_covered() {
  bool covered = true;
  for (int q = 0; q < flat_; ++q)
    if (!search_.covers(q, gap_functions_[q].of_points)) {
      search_.look(q, gap_functions_[q].of_points, move_.abs().maxCoeff());
      operations().spend(Operations::of_value * samples_.count());
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
  for (const Force& each : forces_) {
    const int q = each.row.plane;
    reactions.push_back({obstacle_[q], each.row.sample, normals_[q], each.force, !own(each.row)});
    if (own(each.row)) {
      reactions.back().solid = tangent_of(q).solid;
      reactions.back().begin = begin_of(each.row);
      reactions.back().place = own_[q];
    }
  }
}

}  // namespace softffd
