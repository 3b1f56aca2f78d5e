#include "contact/implicit/implicit_contact.hpp"

#include <algorithm>
#include <cmath>

#include "contact/implicit/point_touches.hpp"
#include "contact/implicit/surface_touches.hpp"
#include "contact/tolerances.hpp"
#include "model/rigid_motion.hpp"

namespace softffd {

namespace {

/// Roundings that add up in the force on a point.
constexpr double roundings = 16;
/// Of the least inertia m / h^2: a change of friction's stiffness that does not matter to the solution.
constexpr double slight_share = 0.05;
/// Of the largest force: what may be left of a balance. Rounding of the forces comes on top.
constexpr double balance_share = 1e-8;
/// Squared angles of the rotation in a Newton step [rad2]: below the first the arms are as long without it, to rounding; below the second
/// the matrix still serves.
constexpr double straight = 1e-15, small_turn = 1e-8;
/// A body that buckles jumps to its next equilibrium as fast as its own vibrations are: for a moment steps have to be that short.
constexpr int most_halvings = 20, most_iterations = 30;
/// Backward Euler gains energy only where a body falls off an edge on which it balances, and then of second order in the step; a solution
/// with more gain than this share of the energies that are exchanged lies on another branch, a folded one for example.
constexpr double most_gain = 0.02;

}  // namespace

ImplicitContact::ImplicitContact(const Lattice& lattice, int planes, const Samples* samples) {
  if (samples)
    touches_ = std::make_unique<SurfaceTouches>(*samples, lattice.largest_side(), planes);
  else
    touches_ = std::make_unique<PointTouches>(lattice, planes);
  const int points = lattice.points();
  reactions_.reserve(std::size_t(points) * planes);
  diagonal_.setZero(points);
  for (Points* each : {&x_, &v_, &u_, &force_, &spring_, &residual_, &last_change_, &scratch_}) each->setZero(points, 3);
}

StepStatus ImplicitContact::advance(const Equations& equations, double t, double h, bool watch, State& state, Exchange& exchange) {
  if (largest_stiffness_ < 0) {
    largest_stiffness_ = 0;
    for (const Springs::Row& row : equations.body.springs.rows())
      largest_stiffness_ = std::max(largest_stiffness_, kernels::largest(row.stiffness.size(), row.stiffness.data()));
  }
  last_factorization_ = factorizations() + most_factorizations;
  last_solution_ = solutions() + double(most_solutions);
  given_ = 0;
  slip_ = {};
  return advance_in_parts(equations, t, h, watch, state, exchange, 0);
}

StepStatus ImplicitContact::advance_in_parts(const Equations& equations, double t, double h, bool watch, State& state, Exchange& exchange,
                                             int depth) {
  const Step step{equations, t, h, state};
  ++steps_;
  StepStatus status = open(step);
  if (status == StepStatus::ok) status = solve(step);
  if (status == StepStatus::ok && close(step)) {
    book(step, watch, exchange);
    given_ += given_by_contacts(step);
    slip_.add(slip_of_contacts(step));
    touches_->hold(state);
    state.x.swap(x_);
    state.v.swap(v_);
    state.spring.swap(spring_);
    return StepStatus::ok;
  }
  if (status != StepStatus::ok && status != StepStatus::not_finite) return status;
  if (depth == most_halvings || spent()) return StepStatus::not_finite;
  ++halvings_;
  const StepStatus first = advance_in_parts(equations, t, 0.5 * h, watch, state, exchange, depth + 1);
  if (first != StepStatus::ok) return first;
  return advance_in_parts(equations, t + 0.5 * h, 0.5 * h, watch, state, exchange, depth + 1);
}

StepStatus ImplicitContact::open(const Step& step) {
  const auto& [body, around] = step.equations;
  force_ = around.force;
  if (around.ramped) around.force_at(step.t + 0.5 * step.h, force_);
  diagonal_ = body.mass / (step.h * step.h) + body.damping / step.h;
  touches_->open(step);
  predict(step);
  x_ = step.from.x + u_;
  step.equations.place_pins(step.t + step.h, x_);
  for (const Pin& pin : around.pins)
    for (int p : pin.points) {
      set_row(u_, p, row(x_, p) - row(step.from.x, p));
      for (std::size_t q = 0; q < around.planes.size(); ++q)
        if (!touches_->pins_pass() && touches_->plane(int(q)).gap(row(x_, p)) < -pin_slack * body.length)
          return StepStatus::pin_behind_plane;
    }
  extent_ = body.length + kernels::largest(x_.size(), x_.data());
  if (!std::isfinite(extent_)) return StepStatus::not_finite;
  if (!touches_->possible(row(x_, 0), position_slack * extent_)) return StepStatus::impossible_planes;
  force_scale_ =
      std::max(kernels::largest(force_.size(), force_.data()), kernels::largest(step.from.spring.size(), step.from.spring.data()));
  const double inertia = diagonal_.maxCoeff() * kernels::largest(u_.size(), u_.data());
  noise_ = roundings * rounding * (largest_stiffness_ * extent_ + inertia + force_scale_);
  slight_ = slight_share * body.mass.minCoeff() / (step.h * step.h);
  touches_->guess(step, force_, x_);
  touches_->refresh();
  convergence_ = {};
  straight_ = false;
  return StepStatus::ok;
}

/// As a rigid body: with the rotation that backward Euler gives it, springs stay as they are.
void ImplicitContact::predict(const Step& step) {
  const RigidMotion motion = rigid_motion(step.equations.body.mass, step.from.x, step.from.v);
  const Vec3 turn = step.h * motion.spin;
  for (int p = 0; p < u_.rows(); ++p) {
    const Vec3 arm = row(step.from.x, p) - motion.centre;
    set_row(u_, p, step.h * motion.velocity + turn.cross(arm) + second_order(turn, arm));
  }
}

StepStatus ImplicitContact::solve(const Step& step) {
  const StepProblem problem{step.equations.body, step.from.x,       u_, x_, residual_, diagonal_, step.h, position_slack * extent_,
                            force_scale_,        largest_stiffness_};
  for (int i = 0; i < most_iterations; ++i) {
    find_residual(step, i == 0);
    if (straight_ && in_balance(step)) return StepStatus::ok;
    ++iterations_;
    if (spent()) return StepStatus::not_finite;
    if (const StepStatus status = touches_->solve(problem, convergence_.cautious()); status != StepStatus::ok) return status;
    move(step);
  }
  return StepStatus::not_finite;
}

/// All forces but those of contact; and the friction at this state.
void ImplicitContact::find_residual(const Step& step, bool first) {
  const Body& body = step.equations.body;
  const double per_h = 1 / step.h;
  body.internal_force(x_, spring_);
  for (int axis = 0; axis < 3; ++axis)
    residual_.col(axis) = force_.col(axis) + spring_.col(axis) - (body.mass * per_h) * (u_.col(axis) * per_h - step.from.v.col(axis)) -
                          (body.damping * per_h) * u_.col(axis);
  if (body.springs.dashpots()) {
    scratch_ = per_h * u_;
    body.springs.add_dashpot_force(x_, scratch_, residual_);
  }
  touches_->find_friction(step, u_, first, largest_stiffness_, slight_);
}

bool ImplicitContact::in_balance(const Step& step) {
  scratch_ = residual_;
  touches_->add_forces(scratch_);
  for (const Pin& pin : step.equations.around.pins)
    for (int p : pin.points) set_row(scratch_, p, Vec3::Zero());
  return kernels::largest(scratch_.size(), scratch_.data()) <= balance_share * std::max(force_scale_, touches_->largest_load()) + noise_;
}

/// Takes the Newton step, its rotation as one. A step that was taken straight keeps the linear equations' balance of momentum.
void ImplicitContact::move(const Step& step) {
  const Body& body = step.equations.body;
  Points& change = touches_->solution().change;
  const RigidMotion motion = rigid_motion(body.mass, x_, change);
  const double angle_squared = motion.spin.squaredNorm();
  const bool settled = touches_->solution().settled;
  straight_ = angle_squared <= straight && settled;
  if (angle_squared > straight)
    for (int p = 0; p < body.points(); ++p)
      if (!body.pinned[p]) set_row(change, p, row(change, p) + second_order(motion.spin, row(x_, p) - motion.centre));
  if (!(angle_squared < small_turn) || !settled || convergence_.cautious()) touches_->refresh();
  keep_converging();
  u_ += change;
  x_ = step.from.x + u_;
  step.equations.place_pins(step.t + step.h, x_);
  last_change_ = change;
}

/// Orders a new matrix where the old one does not serve any more; halves a change that goes back where the iterations run in circles.
void ImplicitContact::keep_converging() {
  Points& change = touches_->solution().change;
  convergence_.add(kernels::largest(change.size(), change.data()), touches_->solution().fresh);
  if (convergence_.needs_matrix()) touches_->refresh();
  if (!convergence_.circles()) return;
  double back = 0;
  for (int i = 0; i < last_change_.size(); ++i) back += change.data()[i] * last_change_.data()[i];
  if (!(back < 0)) return;
  change *= 0.5;
  straight_ = false;
}

/// The state at the end, exactly in front of the planes, and the step's energies. Returns whether the solution can be believed.
bool ImplicitContact::close(const Step& step) {
  const auto& [body, around] = step.equations;
  touches_->find_reactions(reactions_);
  v_ = u_ / step.h;
  step.equations.place_pins(step.t + step.h, x_, v_);
  spread_rounding(step);
  x_ = step.from.x + u_;
  touches_->keep_in_front(body, x_);
  step.equations.place_pins(step.t + step.h, x_, v_);
  body.internal_force(x_, spring_);
  double before = 0, gain = 0, outside = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (int p = 0; p < body.points(); ++p) {
      const double v0 = step.from.v(p, axis), v1 = v_(p, axis);
      before += 0.5 * body.mass[p] * v0 * v0;
      gain += 0.5 * body.mass[p] * (v1 - v0) * (v1 + v0);
      outside += force_(p, axis) * (x_(p, axis) - step.from.x(p, axis));
    }
  const double elastic0 = body.elastic_energy(step.from.x), elastic1 = body.elastic_energy(x_);
  work_ = contact_work(step);
  loss_ = outside + work_ + (elastic0 - elastic1) - gain;
  const double exchanged = before + elastic0 + std::abs(outside) + std::abs(work_);
  return std::isfinite(loss_) && loss_ >= -most_gain * exchanged - noise_ * extent_;
}

/// What the linear equations' rounding leaves of the momentum balance, which grows with the stiffness, goes to planes and pins in equal
/// parts; a body that touches nothing moves as a whole by so much.
void ImplicitContact::spread_rounding(const Step& step) {
  const Body& body = step.equations.body;
  rounding_.setZero();
  Vec3 missing = Vec3::Zero();
  double inertia = 0;
  int holders = int(std::count_if(reactions_.begin(), reactions_.end(), [](const Reaction& each) { return each.first; }));
  for (int p = 0; p < body.points(); ++p) {
    missing += body.mass[p] * (row(v_, p) - row(step.from.v, p)) + body.damping[p] * row(u_, p) - step.h * row(force_, p);
    inertia += body.mass[p] + step.h * body.damping[p];
  }
  for (const Reaction& each : reactions_) missing -= impulse(step, each);
  for (const Pin& pin : step.equations.around.pins) {
    holders += int(pin.points.size());
    for (int p : pin.points) missing -= pin_impulse(step, p);
  }
  if (holders > 0) {
    rounding_ = missing / holders;
    return;
  }
  const Vec3 excess = missing / inertia;
  for (int p = 0; p < body.points(); ++p) {
    set_row(v_, p, row(v_, p) - excess);
    set_row(u_, p, row(u_, p) - step.h * excess);
  }
}

/// Of planes and pins on the body.
double ImplicitContact::contact_work(const Step& step) const {
  double work = 0;
  for (const Reaction& each : reactions_) work += impulse(step, each).dot(material_velocity(step, each));
  for (const Pin& pin : step.equations.around.pins)
    for (int p : pin.points) work += pin_impulse(step, p).dot(row(u_, p)) / step.h;
  return work;
}

/// The same with friction, at the mean of the velocities.
double ImplicitContact::given_by_contacts(const Step& step) const {
  double given = work_;
  for (const Reaction& each : reactions_) {
    const Vec3 slip = 0.5 * (touches_->value(each, step.from.v) + touches_->value(each, v_)) - material_velocity(step, each);
    given += impulse(step, each).dot(tangential(each.normal, slip));
  }
  return given;
}

/// Slip at the beginning counts as far as it is more than what the obstacle's own speed changes by in the step: what sticks to an obstacle
/// has its speed of before.
Slip ImplicitContact::slip_of_contacts(const Step& step) const {
  Slip sum;
  for (const Reaction& each : reactions_) {
    const Plane& plane = step.equations.around.planes[each.plane];
    const double load = each.normal.dot(each.force), limit = plane.friction * load;
    if (!(limit > 0)) continue;
    const Vec3 place = touches_->value(each, step.from.x);
    const Vec3 surface = plane.at(step.t).material_velocity(place), later = plane.at(step.t + step.h).material_velocity(place);
    const Vec3 begin = tangential(each.normal, touches_->value(each, step.from.v) - surface);
    const Vec3 end = tangential(each.normal, touches_->value(each, v_) - material_velocity(step, each));
    sum.add_contact(load, limit, tangential(each.normal, each.force), begin, end, (later - surface).norm());
  }
  return sum;
}

/// Of the obstacle where it touches, seen at mid-step.
Vec3 ImplicitContact::material_velocity(const Step& step, const Reaction& at) const {
  return touches_->material_velocity(at.plane, touches_->value(at, step.from.x) + 0.5 * touches_->value(at, u_));
}

/// On the body.
Vec3 ImplicitContact::impulse(const Step& step, const Reaction& reaction) const {
  if (!reaction.first) return step.h * reaction.force;
  return step.h * reaction.force + rounding_;
}

/// On the point, which ends with the velocity of its frame instead of the step's.
Vec3 ImplicitContact::pin_impulse(const Step& step, int p) const {
  return step.h * row(touches_->solution().reaction, p) + step.equations.body.mass[p] * (row(v_, p) - row(u_, p) / step.h) + rounding_;
}

void ImplicitContact::book(const Step& step, bool watch, Exchange& exchange) const {
  const Drive& around = step.equations.around;
  for (const Reaction& each : reactions_) {
    exchange.planes[each.plane].add(-impulse(step, each), touches_->value(each, x_) - touches_->plane(each.plane).point);
    exchange.contacts_resolved += each.first;
  }
  for (std::size_t a = 0; a < around.pins.size(); ++a) {
    const Vec3 origin = around.pins[a].at(step.t + step.h).origin;
    for (int p : around.pins[a].points) exchange.pins[a].add(-pin_impulse(step, p), row(x_, p) - origin);
  }
  if (!watch) return;
  exchange.work += work_;
  exchange.dissipated += loss_;
  if (around.ramped) exchange.work += around.ramp_dot(step.t + 0.5 * step.h, x_ - step.from.x);
}

}  // namespace softffd
