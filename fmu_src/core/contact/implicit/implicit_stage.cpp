#include "contact/implicit/implicit_stage.hpp"

#include <algorithm>
#include <cmath>

#include "body/rigid_motion.hpp"
#include "contact/implicit/point_touches.hpp"
#include "contact/implicit/surface_touches.hpp"
#include "contact/surface/tangents.hpp"
#include "contact/tolerances.hpp"

namespace softffd {

namespace {

/// Number of roundings that add up in the force on a point [1].
constexpr double roundings = 16;
/// A change of friction's stiffness below this fraction of the least inertia m / h^2 does not matter to the solution [1].
constexpr double slight_fraction = 0.05;
/// Fraction of the missing loads of sliding points that may be left for the next iteration [1]: `rough_loads` if the step is solved to a
/// distance (Step::way), `fine_loads` if to rounding.
constexpr double rough_loads = 1e-2, fine_loads = 1e-4;
/// An obstacle strikes what touches it if it approaches in a step by more than this fraction of the box (`slight_approach`) and than this
/// multiple of the distance by which a solution may be off (`jump`) [1].
constexpr double slight_approach = 1e-6, jump = 1e3;
/// Accuracy of the loads, as a fraction of the accuracy of the balance [1].
constexpr double of_loads = 0.1;
/// Squared angles of the rotation in a Newton step [rad2]. Up to `straight`, arms keep their lengths to rounding without the second-order
/// term. Below `small_turn` the matrix still serves.
constexpr double straight = 1e-15, small_turn = 1e-8;
constexpr int most_iterations = 30;
/// Relative difference up to which two steps are equally long, to rounding [1].
constexpr double same_length = 1e-9;
/// A contact counts as sliding if its friction is at least this fraction of the Coulomb limit [1].
constexpr double slides_from = 1 - 1e-3;

/// splitmix64. Sums of its values tell sets apart.
std::uint64_t mixed(std::uint64_t value) {
  value += 0x9e3779b97f4a7c15;
  value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9;
  value = (value ^ (value >> 27)) * 0x94d049bb133111eb;
  return value ^ (value >> 31);
}

}  // namespace

ImplicitStage::ImplicitStage(const Lattice& lattice, int planes, const Samples* samples) : samples_(samples) {
  if (!samples && lattice.lobatto) {  // its matrix is too dense to be factored for each change of friction
    nodes_ = std::make_unique<Samples>(lattice);
    samples_ = nodes_.get();
  }
  if (samples_)
    touches_ = std::make_unique<SurfaceTouches>(*samples_, lattice.largest_side(), planes);
  else
    touches_ = std::make_unique<PointTouches>(lattice, planes);
  const int points = lattice.points();
  reactions_.reserve(std::size_t(points) * planes);
  diagonal_.setZero(points);
  for (Points* each : {&x, &v, &spring, &u_, &force_, &residual_, &last_change_, &scratch_}) each->setZero(points, 3);
}

StepStatus ImplicitStage::solve(const Step& step) {
  if (largest_stiffness_ < 0) largest_stiffness_ = step.equations.body.largest_stiffness();
  StepStatus status = open(step);
  if (status == StepStatus::ok) status = iterate(step);
  if (status != StepStatus::ok) return status;
  close(step);
  return presses_solids(step) ? StepStatus::ok : StepStatus::beside_solid;
}

/// True if the reactions at half-spaces that stand for solids press on these solids.
bool ImplicitStage::presses_solids(const Step& step) const {
  return std::ranges::all_of(reactions_, [&](const Reaction& each) {
    const Plane& solid = step.equations.around.planes[each.plane];
    return !solid.stood_for() || !on_body(each) || each.force.isZero(0) ||
           solid.holds(solid.pose_at(step.t + step.h), touches_->value(each, x), touching * step.equations.body.length);
  });
}

StepStatus ImplicitStage::open(const Step& step) {
  const auto& [body, around] = step.equations;
  force_ = around.force;
  if (around.ramped) around.force_at(step.loads_at, force_);
  diagonal_ = body.mass / (step.h * step.h) + body.damping / step.h;
  touches_->open(step);
  predict(step);
  x = step.from.x + u_;
  open_parts(step);
  place_pins(step);
  for (const Pin& pin : around.pins)
    for (int p : pin.points) {
      set_row(u_, p, row(x, p) - row(step.from.x, p));
      for (std::size_t q = 0; q < around.planes.size(); ++q)
        if (!touches_->pins_pass() && touches_->plane(int(q)).gap(row(x, p)) < -pin_slack * body.length)
          return StepStatus::pin_behind_plane;
    }
  extent_ = body.length + kernels::largest(x.size(), x.data());
  if (!std::isfinite(extent_)) return StepStatus::not_finite;
  if (!touches_->possible(row(x, 0), position_slack * extent_)) return StepStatus::impossible_planes;
  force_scale_ =
      std::max(kernels::largest(force_.size(), force_.data()), kernels::largest(step.from.spring.size(), step.from.spring.data()));
  double inertia = diagonal_.maxCoeff() * kernels::largest(u_.size(), u_.data());
  for (const FreeMotion& each : around.free) {
    if (!each.part()) continue;
    force_scale_ = std::max(force_scale_, each.loads(free[each.index()]).force.norm());
    inertia = std::max(inertia, each.mass() / (step.h * step.h) * kernels::largest(u_.size(), u_.data()));
  }
  noise_ = roundings * rounding * (largest_stiffness_ * extent_ + inertia + force_scale_);
  slight_ = slight_fraction * body.mass.minCoeff() / (step.h * step.h);
  scratch_ = force_;
  if (step.along && body.dashpots()) body.add_dashpot_force(step.from.x, *step.along, scratch_);
  touches_->guess(step, scratch_, x);
  if (step.same_matrix && std::abs(step.h - matrix_h_) <= same_length * step.h)
    touches_->keep(slight_);
  else if (!(step.kept && std::abs(step.h - step.kept->h) <= same_length * step.h && touches_->resume(step)))
    touches_->refresh();
  matrix_h_ = step.h;
  convergence_ = {};
  straight_ = false;
  return StepStatus::ok;
}

/// Predicts the displacement of the step: that of the given motion, otherwise that of a rigid body. The rotation is the one that backward
/// Euler gives a rigid body, so that it does not stretch springs.
void ImplicitStage::predict(const Step& step) {
  const RigidMotion motion = rigid_motion(step.equations.body.mass, step.from.x, step.along ? *step.along : step.from.v);
  const Vec3 turn = step.h * motion.spin;
  for (int p = 0; p < u_.rows(); ++p) {
    const Vec3 arm = row(step.from.x, p) - motion.centre;
    const Vec3 straight = step.along ? Vec3(step.h * row(*step.along, p)) : Vec3(step.h * motion.velocity + turn.cross(arm));
    set_row(u_, p, step.turned ? straight : Vec3(straight + second_order(turn, arm)));
  }
}

StepStatus ImplicitStage::iterate(const Step& step) {
  StepProblem problem{step.equations.body,
                      step.from.x,
                      u_,
                      x,
                      residual_,
                      diagonal_,
                      step.h,
                      position_slack * extent_,
                      force_scale_,
                      largest_stiffness_,
                      step.way > 0 ? rough_loads : fine_loads,
                      of_loads * step.accuracy};
  for (int i = 0; i < most_iterations; ++i) {
    const bool same_friction = find_residual(step, i == 0);
    problem.parts = parts_;
    if (straight_ && ((same_friction && convergence_.left() <= step.way) || in_balance(step))) return StepStatus::ok;
    ++iterations_;
    if (spent()) return StepStatus::not_finite;
    if (const StepStatus status = touches_->solve(problem, convergence_.cautious()); status != StepStatus::ok) return status;
    move(step);
  }
  return StepStatus::not_finite;
}

/// Computes all forces but those of contact, and the friction at this state. Returns false if friction differs from that of the last
/// change.
bool ImplicitStage::find_residual(const Step& step, bool first) {
  const Body& body = step.equations.body;
  const double per_h = 1 / step.h;
  body.internal_force(x, spring);
  for (int axis = 0; axis < 3; ++axis)
    residual_.col(axis) = force_.col(axis) + spring.col(axis) - (body.mass * per_h) * (u_.col(axis) * per_h - step.from.v.col(axis)) -
                          (body.damping * per_h) * u_.col(axis);
  if (body.dashpots()) {
    scratch_ = per_h * u_;
    body.add_dashpot_force(x, scratch_, residual_);
  }
  find_parts_residual(step);
  return touches_->find_friction(step, u_, first, largest_stiffness_, slight_);
}

bool ImplicitStage::in_balance(const Step& step) {
  scratch_ = residual_;
  touches_->add_forces(scratch_);
  const double slack = step.accuracy * std::max(force_scale_, touches_->largest_load()) + noise_;
  if (!parts_in_balance(slack)) return false;
  for (const Pin& pin : step.equations.around.pins)
    for (int p : pin.points) set_row(scratch_, p, Vec3::Zero());
  return kernels::largest(scratch_.size(), scratch_.data()) <= slack;
}

/// Takes the Newton step, its rotation as a rotation. A step taken straight keeps the momentum balance of the linear equations.
void ImplicitStage::move(const Step& step) {
  const Body& body = step.equations.body;
  Points& change = touches_->solution().change;
  const RigidMotion motion = rigid_motion(body.mass, x, change);
  const double angle_squared = std::max(motion.spin.squaredNorm(), move_parts(step, change));
  const bool settled = touches_->solution().settled;
  straight_ = angle_squared <= straight && settled && !touches_->solution().again;
  if (angle_squared > straight)
    for (int p = 0; p < body.points(); ++p)
      if (!body.pinned[p]) set_row(change, p, row(change, p) + second_order(motion.spin, row(x, p) - motion.centre));
  if (!(angle_squared < small_turn) || !settled || convergence_.cautious()) touches_->refresh();
  keep_converging();
  u_ += change;
  x = step.from.x + u_;
  place_pins(step);
  last_change_ = change;
}

/// Orders a new matrix where the old one does not serve any more. Halves a change that goes back where the iterations run in circles.
void ImplicitStage::keep_converging() {
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

/// Sets the state at the end of the step, exactly in front of the planes.
void ImplicitStage::close(const Step& step) {
  touches_->find_reactions(reactions_);
  v = u_ / step.h;
  const auto give_frames = [&] {
    place_pins(step);
    for (const Pin& pin : step.equations.around.pins) {
      const Frame frame = frame_of(step, pin);
      for (std::size_t n = 0; n < pin.points.size(); ++n) set_row(v, pin.points[n], frame.material_velocity(frame.arm(pin.local[n])));
    }
  };
  give_frames();
  spread_rounding(step);
  push_free(step);
  x = step.from.x + u_;
  touches_->keep_in_front(step.equations.body, x);
  give_frames();
  step.equations.body.internal_force(x, spring);
  std::uint64_t sum = 0;
  for (const Reaction& each : reactions_) {
    const double limit = friction_of(step, each) * each.normal.dot(each.force);
    const bool slides = tangential(each.normal, each.force).norm() >= slides_from * limit;
    sum += mixed(2 * (std::uint64_t(each.plane) << 32 | std::uint64_t(each.at)) + slides);
  }
  constraints_ = Count(sum >> 1);
}

/// Distributes what the rounding of the linear equations leaves of the momentum balance, which grows with the stiffness. Touching places
/// and pinned points take equal parts of it. A body that touches nothing moves as a whole by it.
void ImplicitStage::spread_rounding(const Step& step) {
  const Body& body = step.equations.body;
  rounding_.setZero();
  Vec3 missing = Vec3::Zero();
  double inertia = 0;
  int holders = int(std::count_if(reactions_.begin(), reactions_.end(), [](const Reaction& each) { return each.first; }));
  for (int p = 0; p < body.points(); ++p) {
    missing += body.mass[p] * (row(v, p) - row(step.from.v, p)) + body.damping[p] * row(u_, p) - step.h * row(force_, p);
    inertia += body.mass[p] + step.h * body.damping[p];
  }
  for (const Reaction& each : reactions_)
    if (on_body(each)) missing -= impulse(step, each);
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
    set_row(v, p, row(v, p) - excess);
    set_row(u_, p, row(u_, p) - step.h * excess);
  }
}

/// The half-space of the obstacle that faces `place` at the start of the step.
HalfSpace ImplicitStage::begin_of(const Step& step, int obstacle, const Vec3& place) const {
  const Plane& plane = step.equations.around.planes[obstacle];
  if (!plane.own) return facing_half_space(plane, step.t, place);
  return tangent(plane, plane.pose_of(step.from.free[plane.own->index()]), place);
}

double ImplicitStage::contact_work(const Step& step) const {
  double work = 0;
  for (const Reaction& each : reactions_)
    if (on_body(each)) work += impulse(step, each).dot(material_velocity(step, each));
  for (const Pin& pin : step.equations.around.pins)
    for (int p : pin.points) work += pin_impulse(step, p).dot(row(u_, p)) / step.h;
  return work;
}

double ImplicitStage::given_by_contacts(const Step& step, double work) const {
  double given = work;
  for (const Reaction& each : reactions_) {
    if (!on_body(each)) continue;
    const Vec3 slip = 0.5 * (touches_->value(each, step.from.v) + touches_->value(each, v)) - material_velocity(step, each);
    given += impulse(step, each).dot(tangential(each.normal, slip));
  }
  return given;
}

/// A place is struck if it was off the obstacle, or if it touched an obstacle that approaches it.
bool ImplicitStage::strikes(const Step& step) const {
  const double length = step.equations.body.length, slight = std::max(slight_approach * length, jump * step.way);
  return std::any_of(reactions_.begin(), reactions_.end(), [&](const Reaction& each) {
    const Vec3 place = place_at_begin(step, each);
    const HalfSpace plane = begin_of(step, each.plane, place);
    const double approach = each.normal.dot(plane.material_velocity(place) - velocity_at_begin(step, each));
    return each.normal.dot(each.force) > 0 &&
           (plane.gap(place) > (on_body(each) ? touching : free_touching) * length || approach * step.h > slight);
  });
}

double ImplicitStage::lost_power(const Step& step) const {
  const Body& body = step.equations.body;
  double power = (body.damping * v.square().rowwise().sum()).sum();
  power += body.dashpot_power(x, v);
  for (const Reaction& each : reactions_)
    if (on_body(each)) power -= each.force.dot(tangential(each.normal, touches_->value(each, v) - material_velocity(step, each)));
  return power;
}

/// Slip at the start of the step counts as far as it exceeds the change of the obstacle's own velocity in the step: a place that sticks to
/// an obstacle has the velocity that the obstacle had before.
Slip ImplicitStage::slip_of_contacts(const Step& step) const {
  Slip sum;
  for (const Reaction& each : reactions_) {
    const double load = each.normal.dot(each.force), limit = friction_of(step, each) * load;
    if (!(limit > 0)) continue;
    const Vec3 place = place_at_begin(step, each);
    const Vec3 surface = begin_of(step, each.plane, place).material_velocity(place);
    const Vec3 later = touches_->plane(each.plane).material_velocity(place);
    const Vec3 begin = tangential(each.normal, velocity_at_begin(step, each) - surface);
    const Vec3 end = tangential(each.normal, velocity_at_end(step, each) - material_velocity(step, each));
    const Vec3 rub = tangential(each.normal, each.force);
    const bool free = step.equations.around.planes[each.plane].own;
    const double change = free ? 0 : (later - surface).norm();
    if (on_body(each)) sum.add_contact(load, limit, rub, begin, end, change);
    if (!on_body(each) || free) sum.add_rigid(limit, rub, begin, end, change);
  }
  return sum;
}

/// Velocity of the obstacle's material at the touching place when it is seen, of a free obstacle at the end of the step [m/s].
Vec3 ImplicitStage::material_velocity(const Step& step, const Reaction& at) const {
  if (const FreeMotion* own = step.equations.around.planes[at.plane].own) {
    const FreeState& end = free[own->index()];
    return end.velocity + own->spin(end).cross(place_at_end(at) - end.position);
  }
  if (!on_body(at)) return touches_->material_velocity(at.plane, at.begin + step.seen * (at.place - at.begin));
  return touches_->material_velocity(at.plane, touches_->value(at, x) - (1 - step.seen) * touches_->value(at, u_));
}

/// Impulse of a reaction on the body, or on the solid whose own sample it is at [N s].
Vec3 ImplicitStage::impulse(const Step& step, const Reaction& reaction) const {
  if (!reaction.first) return step.h * reaction.force;
  return step.h * reaction.force + rounding_;
}

/// Impulse of a pin on its point p [N s]. The point ends with the velocity of its frame instead of the velocity u / h of the step.
Vec3 ImplicitStage::pin_impulse(const Step& step, int p) const {
  return step.h * row(touches_->solution().reaction, p) + step.equations.body.mass[p] * (row(v, p) - row(u_, p) / step.h) + rounding_;
}

void ImplicitStage::book(const Step& step, double weight, Exchange& exchange) const {
  const Drive& around = step.equations.around;
  for (const Reaction& each : reactions_) {
    if (!on_body(each)) {
      const auto [other, given, work] = on_free(step, each);
      exchange.planes[other].add(-weight * given, each.place - pose_of(step, other, true).point);
      continue;
    }
    const Vec3 arm = touches_->value(each, x) - touches_->plane(each.plane).point, taken = weight * impulse(step, each);
    exchange.planes[each.plane].add(-taken, arm);
    exchange.touch(each.plane, each.at, taken);
    if (around.planes[each.plane].PlaneMotion::solid()) exchange.planes[each.plane].press(each.normal.dot(taken), arm);
    exchange.contacts_resolved += each.first;
  }
  for (std::size_t a = 0; a < around.pins.size(); ++a) {
    const Vec3 origin = frame_of(step, around.pins[a]).origin;
    for (int p : around.pins[a].points) exchange.pins[a].add(-weight * pin_impulse(step, p), row(x, p) - origin);
  }
}

}  // namespace softffd
