/// Free bodies in an implicit step: parts of free pins, which are unknowns of its equations, and impulses of reactions on obstacles.
#include <algorithm>

#include "body/rigid_motion.hpp"
#include "contact/implicit/implicit_stage.hpp"
#include "contact/implicit/surface_touches.hpp"

namespace softffd {

/// The frame of a pin at the end of the step.
Frame ImplicitStage::frame_of(const Step& step, const Pin& pin) const {
  return pin.own ? pin.frame_of(free[pin.own->index()]) : pin.at(step.t + step.h);
}

void ImplicitStage::place_pins(const Step& step) {
  for (const Pin& pin : step.equations.around.pins) {
    const Frame frame = frame_of(step, pin);
    for (std::size_t n = 0; n < pin.points.size(); ++n) {
      const int p = pin.points[n];
      set_row(x, p, frame.origin + frame.arm(pin.local[n]));
      if (pin.own) set_row(u_, p, row(x, p) - row(step.from.x, p));
    }
  }
}

/// Opens the parts of free pins. At first each part goes on as it moved before.
void ImplicitStage::open_parts(const Step& step) {
  free = step.from.free;
  parts_.clear();
  for (const FreeMotion& each : step.equations.around.free) {
    if (!each.part()) continue;
    const FreeState& from = step.from.free[each.index()];
    parts_.push_back({.points = &step.equations.around.pins[each.body().pin].points,
                      .guide = each.body().guide,
                      .mass = each.mass(),
                      .moved = {step.h * from.velocity, step.h * each.spin(from)}});
    place_part(step, each, parts_.back());
  }
}

/// Places a part where it has moved to in the step, with the velocities that take it there.
void ImplicitStage::place_part(const Step& step, const FreeMotion& body, const FreePart& part) {
  const FreeState& from = step.from.free[body.index()];
  FreeState& end = free[body.index()];
  end = {.time = step.t + step.h, .position = from.position + part.moved.move, .velocity = part.moved.move / step.h};
  end.orientation = turned(from.orientation, part.moved.turn);
  end.momentum = body.momentum(end, part.moved.turn / step.h);
}

void ImplicitStage::find_parts_residual(const Step& step) {
  auto part = parts_.begin();
  const double per_h = 1 / step.h;
  for (const FreeMotion& each : step.equations.around.free) {
    if (!each.part()) continue;
    const FreeState& from = step.from.free[each.index()];
    const FreeState& end = free[each.index()];
    part->centre = end.position;
    part->inertia = each.inertia(end);
    part->lack = each.loads(end);
    part->lack.force -= per_h * each.mass() * (end.velocity - from.velocity);
    part->lack.torque -= per_h * (end.momentum - from.momentum);
    for (const int p : *part->points) {
      const Vec3 inertia = per_h * step.equations.body.mass[p] * (per_h * row(u_, p) - row(step.from.v, p));
      part->lack.force += inertia;
      part->lack.torque += (row(x, p) - end.position).cross(inertia);
    }
    ++part;
  }
}

/// Moves the parts to where a change has moved their points. Returns the square of the largest turn [rad2].
double ImplicitStage::move_parts(const Step& step, const Points& change) {
  double largest = 0;
  auto part = parts_.begin();
  for (const FreeMotion& each : step.equations.around.free) {
    if (!each.part()) continue;
    const std::vector<int>& points = *part->points;
    Twist& moved = part->moved;
    const Vec3 centre = free[each.index()].position;
    if (each.body().guided()) {
      moved.move += row(change, points.front());
      place_part(step, each, *part++);
      continue;
    }
    const int n = int(points.size());
    Points at(n, 3), by(n, 3);
    for (int i = 0; i < n; ++i) {
      set_row(at, i, row(x, points[i]));
      set_row(by, i, row(change, points[i]));
    }
    const RigidMotion motion = rigid_motion(Scalars::Ones(n), at, by);
    moved.move += motion.velocity + motion.spin.cross(centre - motion.centre);
    moved.turn += motion.spin + 0.5 * motion.spin.cross(moved.turn);  // composes two turns, to second order
    place_part(step, each, *part++);
    largest = std::max(largest, motion.spin.squaredNorm());
  }
  return largest;
}

/// True if each part is in balance, to within `slack` [N]. scratch_ must hold the residual of the points' balance with all forces.
bool ImplicitStage::parts_in_balance(double slack) const {
  return std::ranges::all_of(parts_, [&](const FreePart& part) {
    Vec3 force = part.lack.force, torque = part.lack.torque;
    double size = 0;
    for (const int p : *part.points) {
      const Vec3 arm = row(x, p) - part.centre;
      force += row(scratch_, p);
      torque += arm.cross(row(scratch_, p));
      size = std::max(size, arm.norm());
    }
    const double most = slack * std::sqrt(double(part.points->size()));
    if (!part.guide.isZero(0)) return std::abs(part.guide.dot(force)) <= most;
    return force.norm() <= most && torque.norm() <= most * size;
  });
}

/// Gives free obstacles the impulses that the reactions are reported to exert on them.
void ImplicitStage::push_free(const Step& step) {
  for (const FreeMotion& each : step.equations.around.free) {
    if (each.part()) continue;  // a part is where its points are
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
    for (const Reaction& reaction : reactions_) {
      const int own = each.body().plane;
      if (reaction.plane != own && reaction.solid != own) continue;
      const Vec3 taken = reaction.solid == own ? impulse(step, reaction) : Vec3(-impulse(step, reaction));
      force += taken;
      torque += (place_at_end(reaction) - touches_->plane(own).point).cross(taken);
    }
    free[each.index()] = each.stepped(step.from.free[each.index()], step.h, force, torque);
  }
}

double ImplicitStage::friction_of(const Step& step, const Reaction& at) {
  const std::vector<Plane>& planes = step.equations.around.planes;
  return on_body(at) ? planes[at.plane].friction : friction_between(planes[at.solid], planes[at.plane]);
}

SolidPose ImplicitStage::pose_of(const Step& step, int obstacle, bool at_end) const {
  const Plane& plane = step.equations.around.planes[obstacle];
  if (plane.own) return plane.pose_of((at_end ? free : step.from.free)[plane.own->index()]);
  return plane.pose_at(at_end ? step.t + step.h : step.t);
}

/// Place at the start of the step of the material that the obstacle meets [m].
Vec3 ImplicitStage::place_at_begin(const Step& step, const Reaction& at) const {
  return on_body(at) ? touches_->value(at, step.from.x) : at.begin;
}

Vec3 ImplicitStage::place_at_end(const Reaction& at) const { return on_body(at) ? touches_->value(at, x) : at.place; }

Vec3 ImplicitStage::velocity_at_begin(const Step& step, const Reaction& at) const {
  return on_body(at) ? touches_->value(at, step.from.v) : pose_of(step, at.solid, false).material_velocity(at.begin);
}

Vec3 ImplicitStage::velocity_at_end(const Step& step, const Reaction& at) const {
  return on_body(at) ? touches_->value(at, v) : pose_of(step, at.solid, true).material_velocity(at.place);
}

ImplicitStage::OnFree ImplicitStage::on_free(const Step& step, const Reaction& at) const {
  const bool free_sample = step.equations.around.planes[at.solid].own;
  const Vec3 given = free_sample ? impulse(step, at) : Vec3(-impulse(step, at));
  const Vec3 velocity = free_sample ? material_velocity(step, at) : pose_of(step, at.solid, true).material_velocity(at.place);
  return {free_sample ? at.plane : at.solid, given, given.dot(velocity)};
}

/// The work that other obstacles do on the free bodies is subtracted.
double ImplicitStage::work_of_free(const Step& step) const {
  double work = 0;
  for (const Pin& pin : step.equations.around.pins)
    for (int p : pin.points)
      if (pin.own) work += pin_impulse(step, p).dot(row(u_, p)) / step.h;
  for (const Reaction& each : reactions_)
    if (!on_body(each))
      work -= on_free(step, each).work;
    else if (step.equations.around.planes[each.plane].own)
      work += impulse(step, each).dot(material_velocity(step, each));
  return work;
}

/// Places free obstacles where the present forces take them by the end of the step. The contact constraints are taken at x.
void SurfaceTouches::place_free(const Points& x) {
  const Drive& around = step_->equations.around;
  const double h = step_->h;
  std::vector<Wrench>& given = placed_by_;
  given.assign(around.free.size(), {});
  free_bodies_.resize(around.free.size());
  if (free_rows_.any()) {
    free_rows_.clear_twists();
    for (const Force& each : forces_) free_rows_.add_force(each.row, each.force);
    given = free_rows_.given();
  }
  for (const FreeMotion& each : around.free) {
    const FreeState& from = step_->from.free[each.index()];
    FreeState& end = free_bodies_[each.index()];
    end = each.stepped(from, h, h * given[each.index()].force, h * given[each.index()].torque);
    const int q = each.body().plane;
    if (q < 0) continue;
    poses_[q] = around.planes[q].pose_of(end);
    end_[q] = seen_[q] = poses_[q];
    seen_[q].point = from.position + step_->seen * (end.position - from.position);
  }
  free_rows_.set_planes(obstacle_, own_);
  free_rows_.set_bodies(around, free_bodies_, x, h * h, false);
  set_.delassus().set_free(&free_rows_);
}

/// Computes the wrench on each free body that the present forces, turned with their half-spaces, exert beyond the one that placed the
/// body. Light bodies move far by it.
void SurfaceTouches::find_lack() {
  lack_.assign(placed_by_.size(), {});
  if (!free_rows_.any()) return;
  free_rows_.clear_twists();
  for (const Force& each : forces_) free_rows_.add_force(each.row, each.force);
  for (std::size_t k = 0; k < lack_.size(); ++k) {
    const Wrench& now = free_rows_.given()[k];
    lack_[k] = {now.force - placed_by_[k].force, now.torque - placed_by_[k].torque};
  }
}

}  // namespace softffd
