#include "contact/implicit_contact.hpp"

#include <algorithm>
#include <cmath>

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

ImplicitContact::ImplicitContact(const Lattice& lattice, int planes) : contacts_(lattice, planes), linear_(lattice) {
  diagonal_.setZero(lattice.points());
  for (Points* points : {&x_, &v_, &u_, &force_, &spring_, &residual_, &last_change_, &scratch_}) points->setZero(lattice.points(), 3);
}

StepStatus ImplicitContact::advance(const Equations& equations, double t, double h, bool watch, State& state, Exchange& exchange) {
  if (largest_stiffness_ < 0) {
    largest_stiffness_ = 0;
    for (const Springs::Row& row : equations.body.springs.rows())
      largest_stiffness_ = std::max(largest_stiffness_, kernels::largest(row.stiffness.size(), row.stiffness.data()));
  }
  last_factorization_ = linear_.factorizations() + most_factorizations;
  last_solution_ = linear_.solutions() + double(most_solutions);
  given_ = 0;
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
    contacts_.hold(state.holds);
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
  contacts_.open(body, around, step.t, step.h, step.from.holds);
  predict(step);
  x_ = step.from.x + u_;
  step.equations.place_pins(step.t + step.h, x_);
  for (const Pin& pin : around.pins)
    for (int p : pin.points) {
      set_row(u_, p, row(x_, p) - row(step.from.x, p));
      for (std::size_t q = 0; q < around.planes.size(); ++q)
        if (contacts_.plane(int(q)).gap(row(x_, p)) < -pin_slack * body.length) return StepStatus::pin_behind_plane;
    }
  extent_ = body.length + kernels::largest(x_.size(), x_.data());
  if (!std::isfinite(extent_)) return StepStatus::not_finite;
  if (!contacts_.possible(row(x_, 0), position_slack * extent_)) return StepStatus::impossible_planes;
  force_scale_ =
      std::max(kernels::largest(force_.size(), force_.data()), kernels::largest(step.from.spring.size(), step.from.spring.data()));
  const double inertia = diagonal_.maxCoeff() * kernels::largest(u_.size(), u_.data());
  noise_ = roundings * rounding * (largest_stiffness_ * extent_ + inertia + force_scale_);
  slight_ = slight_share * body.mass.minCoeff() / (step.h * step.h);
  guess_touches(step);
  linear_.refresh();
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

/// Points on a plane that the other forces press against it, as if they were in equilibrium, and points that would end behind one.
void ImplicitContact::guess_touches(const Step& step) {
  const auto& [body, around] = step.equations;
  for (std::size_t q = 0; q < around.planes.size(); ++q) {
    const HalfSpace begin = around.planes[q].at(step.t);
    for (int p = 0; p < body.points(); ++p) {
      if (body.pinned[p]) continue;
      const double load = -begin.normal.dot(row(step.from.spring, p) + row(force_, p));
      const bool rests = load > 0 && begin.gap(row(step.from.x, p)) <= touching * body.length;
      if (rests || contacts_.plane(int(q)).gap(row(x_, p)) < 0) contacts_.add(p, int(q), rests ? load : 0);
    }
  }
}

StepStatus ImplicitContact::solve(const Step& step) {
  const LinearContact::Problem problem{
      step.equations.body, step.from.x, u_, x_, residual_, diagonal_, step.h, position_slack * extent_, force_scale_, largest_stiffness_};
  for (int i = 0; i < most_iterations; ++i) {
    find_residual(step, i == 0);
    if (straight_ && in_balance(step)) return StepStatus::ok;
    ++iterations_;
    if (spent() || !linear_.solve(problem, contacts_, convergence_.cautious())) return StepStatus::not_finite;
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
  if (contacts_.scale_friction(body.length, largest_stiffness_)) linear_.refresh();
  if (first) {
    scratch_ = step.h * step.from.v;
    contacts_.guess_friction(step.from.x, u_, scratch_, step.h);
  } else if (contacts_.find_friction(step.from.x, u_, step.h, slight_)) {
    linear_.refresh();
  }
}

bool ImplicitContact::in_balance(const Step& step) {
  scratch_ = residual_;
  for (int p : contacts_.points())
    for (int i = 0; i < contacts_.touches(p); ++i) {
      const ContactSet::Touch& touch = contacts_.touch(p, i);
      set_row(scratch_, p, row(scratch_, p) + touch.load * touch.normal + touch.friction);
    }
  for (const Pin& pin : step.equations.around.pins)
    for (int p : pin.points) set_row(scratch_, p, Vec3::Zero());
  return kernels::largest(scratch_.size(), scratch_.data()) <= balance_share * std::max(force_scale_, contacts_.largest_load()) + noise_;
}

/// Takes the Newton step, its rotation as one. A step that was taken straight keeps the linear equations' balance of momentum.
void ImplicitContact::move(const Step& step) {
  const Body& body = step.equations.body;
  Points& change = linear_.change;
  const RigidMotion motion = rigid_motion(body.mass, x_, change);
  const double angle_squared = motion.spin.squaredNorm();
  straight_ = angle_squared <= straight && linear_.settled;
  if (angle_squared > straight)
    for (int p = 0; p < body.points(); ++p)
      if (!body.pinned[p]) set_row(change, p, row(change, p) + second_order(motion.spin, row(x_, p) - motion.centre));
  if (!(angle_squared < small_turn) || !linear_.settled || convergence_.cautious()) linear_.refresh();
  keep_converging();
  u_ += change;
  x_ = step.from.x + u_;
  step.equations.place_pins(step.t + step.h, x_);
  last_change_ = change;
}

/// Orders a new matrix where the old one does not serve any more; halves a change that goes back where the iterations run in circles.
void ImplicitContact::keep_converging() {
  Points& change = linear_.change;
  convergence_.add(kernels::largest(change.size(), change.data()), linear_.fresh);
  if (convergence_.needs_matrix()) linear_.refresh();
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
  v_ = u_ / step.h;
  step.equations.place_pins(step.t + step.h, x_, v_);
  spread_rounding(step);
  x_ = step.from.x + u_;
  for (int p = 0; p < body.points(); ++p) {
    if (body.pinned[p]) continue;
    Vec3 here = row(x_, p);
    push_out(contacts_.planes(), here);
    set_row(x_, p, here);
  }
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
  int holders = int(contacts_.points().size());
  for (int p = 0; p < body.points(); ++p) {
    missing += body.mass[p] * (row(v_, p) - row(step.from.v, p)) + body.damping[p] * row(u_, p) - step.h * row(force_, p);
    inertia += body.mass[p] + step.h * body.damping[p];
  }
  for (int p : contacts_.points())
    for (int i = 0; i < contacts_.touches(p); ++i) missing -= touch_impulse(step, p, i);
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
  for (int p : contacts_.points())
    for (int i = 0; i < contacts_.touches(p); ++i)
      work +=
          touch_impulse(step, p, i).dot(contacts_.material_velocity(contacts_.touch(p, i).plane, row(step.from.x, p) + 0.5 * row(u_, p)));
  for (const Pin& pin : step.equations.around.pins)
    for (int p : pin.points) work += pin_impulse(step, p).dot(row(u_, p)) / step.h;
  return work;
}

/// The same with friction, at the mean of the velocities.
double ImplicitContact::given_by_contacts(const Step& step) const {
  double given = work_;
  for (int p : contacts_.points())
    for (int i = 0; i < contacts_.touches(p); ++i) {
      const ContactSet::Touch& touch = contacts_.touch(p, i);
      const Vec3 surface = contacts_.material_velocity(touch.plane, row(step.from.x, p) + 0.5 * row(u_, p));
      const Vec3 slip = 0.5 * (row(step.from.v, p) + row(v_, p)) - surface;
      given += touch_impulse(step, p, i).dot(tangential(touch.normal, slip));
    }
  return given;
}

/// On the point. Of several touches the first gets what the others leave of the linear equations' reaction.
Vec3 ImplicitContact::touch_impulse(const Step& step, int p, int i) const {
  const auto force = [&](int n) {
    const ContactSet::Touch& touch = contacts_.touch(p, n);
    return Vec3(touch.load * touch.normal + ContactSet::linear_friction(touch, row(linear_.change, p)));
  };
  if (i > 0) return step.h * force(i);
  Vec3 left = row(linear_.reaction, p);
  for (int n = 1; n < contacts_.touches(p); ++n) left -= force(n);
  return step.h * left + rounding_;
}

/// On the point, which ends with the velocity of its frame instead of the step's.
Vec3 ImplicitContact::pin_impulse(const Step& step, int p) const {
  return step.h * row(linear_.reaction, p) + step.equations.body.mass[p] * (row(v_, p) - row(u_, p) / step.h) + rounding_;
}

void ImplicitContact::book(const Step& step, bool watch, Exchange& exchange) const {
  const Drive& around = step.equations.around;
  for (int p : contacts_.points()) {
    for (int i = 0; i < contacts_.touches(p); ++i) {
      const int q = contacts_.touch(p, i).plane;
      exchange.planes[q].add(-touch_impulse(step, p, i), row(x_, p) - contacts_.plane(q).point);
    }
    ++exchange.contacts_resolved;
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
