/// Impulses of surface contact on obstacles, pins and free bodies, the energy that contact takes, and tangents of bodies that turn.
#include <algorithm>

#include "contact/surface/surface_contact.hpp"

namespace softffd {

/// Finds the places of the rows of a stage after the stage.
void SurfaceContact::find_places(const SurfaceStage& stage, const Points& x1) {
  places_.clear();
  for (const SurfaceRow& row : stage.rows) {
    const bool moved = &stage == &drift_ && own(row);
    places_.push_back(moved ? Vec3(tangent_of(row).flown + free_rows_.motion_of_solid(row)) : begin_of(row, x1));
  }
}

/// Books the impulses of a stage, its forces times per_force [N s]. Returns the work of the prescribed motion of obstacles and pins [J].
double SurfaceContact::book(const StepView& step, const SurfaceStage& stage, double per_force, Exchange& exchange) {
  double work = 0;
  Impulse taken;
  for (std::size_t t = 0; t < stage.rows.size(); ++t) {
    const int q = stage.rows[t].plane;
    const Vec3 impulse = per_force * stage.force(int(t));
    if (own(stage.rows[t])) {
      work += book_own(step, stage.rows[t], places_[t], impulse, exchange);
      continue;
    }
    taken.add(-impulse, places_[t] - end_[q].point);
    exchange.touch(obstacle_[q], stage.rows[t].sample, impulse);
    if (step.around.planes[obstacle_[q]].PlaneMotion::solid()) taken.press(end_[q].normal.dot(impulse), places_[t] - end_[q].point);
    if ((q >= flat_ || !still_[q]) && !step.around.planes[obstacle_[q]].own) work += impulse.dot(end_[q].material_velocity(places_[t]));
    if (t + 1 < stage.rows.size() && stage.rows[t + 1].plane == q) continue;
    exchange.planes[obstacle_[q]] += taken;
    taken = {};
  }
  exchange.work += work;
  return step.around.pins.empty() ? work : work + give_pins(step, stage, per_force, exchange);
}

/// Includes the compliance of free bodies in the rows of the next stage, which are at x. Does nothing if there are no free bodies.
void SurfaceContact::set_free(const Drive& around, const std::vector<FreeState>& free, const Points& x) {
  if (around.free.empty()) return;
  free_rows_.set_bodies(around, free, x, 1, true);
  free_rows_.set_planes(obstacle_, own_);
  for (SurfaceStage* stage : {&drift_, &close_}) stage->set_free(&free_rows_);
}

/// Applies the forces of a stage times `rate` to the free bodies and, if `move` is set, also moves these bodies. The lever arms are those
/// of the stage's rows, so that the total angular momentum is conserved.
void SurfaceContact::give_free(const SurfaceStage& stage, const Drive& around, double rate, bool move, std::vector<FreeState>& free) const {
  for (std::size_t k = 0; k < free.size() && !stage.rows.empty(); ++k) {
    const auto& [force, torque] = free_rows_.given()[k];
    around.free[k].push(free[k], rate * force, rate * torque);
    if (!move) continue;
    free[k].position += free_rows_.twists()[k].move;
    if (!free_rows_.twists()[k].turn.isZero(0)) free[k].orientation = turned(free[k].orientation, free_rows_.twists()[k].turn);
  }
}

/// Books the work of contact on free bodies in the step: the change of their kinetic energy less the work of their loads.
void SurfaceContact::book_free(const StepView& step, const std::vector<FreeState>& free, Exchange& exchange) const {
  for (std::size_t k = 0; k < free.size(); ++k) {
    const FreeMotion& body = step.around.free[k];
    if (body.part()) continue;  // its pin is booked
    const FreeState &start = free_start_[k], &end = free[k];
    const auto [force, torque] = body.mean_loads(start, step.h);
    const double loads = 0.5 * step.h * (force.dot(start.velocity + end.velocity) + torque.dot(body.spin(start) + body.spin(end)));
    const double work = body.kinetic_energy(end) - body.kinetic_energy(start) - loads;
    exchange.work -= work;
    exchange.dissipated -= work;
  }
}

/// Returns the largest distance by which the rows have moved any free obstacle [m].
double SurfaceContact::obstacles_way(const Drive& around) const {
  double most = 0;
  for (const FreeMotion& each : around.free) {
    if (each.body().plane < 0) continue;
    const Twist& twist = free_rows_.twists()[each.index()];
    most = std::max(most, twist.move.norm() + around.planes[each.body().plane].size() * twist.turn.norm());
  }
  return most;
}

/// If the rows have turned an obstacle, samples may be behind it by an amount of second order in the turn. Lifts the supporting
/// half-spaces of these samples by that amount. Returns whether any was lifted.
bool SurfaceContact::lift_tangents(const StepView& step, const Points& x1, const std::vector<FreeState>& free) {
  if (drift_.rows.empty() || std::ranges::all_of(free_rows_.twists(), [](const Twist& each) { return each.turn.isZero(0); })) return false;
  bool lifted = false;
  const double slack = 2 * slack_of_rows(), way = tangents_.way(step.x0, x1 + drift_.move());
  std::vector<FreeState> moved = free;
  for (const FreeMotion& each : step.around.free) {
    FreeState& state = moved[each.index()] = each.flown(free[each.index()], step.t1);
    state.position += free_rows_.twists()[each.index()].move;
    state.orientation = turned(state.orientation, free_rows_.twists()[each.index()].turn);
  }
  for (std::size_t i = 0; i < tangents_.found().size(); ++i) {
    const Tangent& found = tangents_.found()[i];
    const Plane& solid = step.around.planes[found.obstacle];
    if (found.solid >= 0) {
      lifted = lift(step, int(i), moved, slack) || lifted;
      continue;
    }
    if (!solid.own) continue;
    const FreeMotion& own = *solid.own;
    const double turn = free_rows_.twists()[own.index()].turn.norm(), size = solid.size();
    const double arms =
        turn * size + way + (own.at(step.t1).position - own.state().position).norm() + step.h * own.spin(own.state()).norm() * size;
    const int q = flat_ + int(i);
    if (turn * arms <= slack || drift_.gaps[q].of_sample > turn * arms) continue;
    const Vec3 place = samples_.at(found.sample, x1) + samples_.at(found.sample, drift_.move());
    const double gap = tangent(solid, solid.pose_of(moved[solid.own->index()]), place).gap(place);
    if (gap >= -slack) continue;
    end_[q].offset -= gap;
    lifted = true;
  }
  return lifted;
}

/// Lifts the supporting half-space of a solid's own sample likewise, with free bodies in the states `moved`.
bool SurfaceContact::lift(const StepView& step, int i, const std::vector<FreeState>& moved, double slack) {
  const Tangent& found = tangents_.found()[i];
  const auto pose = [&](int q) {
    const Plane& plane = step.around.planes[q];
    return plane.own ? plane.pose_of(moved[plane.own->index()]) : plane.pose_at(step.t1);
  };
  const double gap = tangents_.gap_of(step.around, found, pose(found.solid), pose(found.obstacle));
  if (gap >= -slack) return false;
  end_[flat_ + i].offset -= gap;
  return true;
}

/// Books the impulse of an obstacle on a solid's own sample [N s]: one of the two is free and is pushed, the other takes the reaction.
/// Returns the work of the other one's prescribed motion on the free one [J].
double SurfaceContact::book_own(const StepView& step, const SurfaceRow& row, const Vec3& place, const Vec3& impulse, Exchange& exchange) {
  const int solid = tangent_of(row).solid;
  const bool free = step.around.planes[solid].own;
  const int other = free ? obstacle_[row.plane] : solid;
  const SolidPose pose = step.around.planes[other].pose_at(step.t1);
  const Vec3 given = free ? impulse : Vec3(-impulse);  // to the free one
  Impulse& taken = exchange.planes[other];
  taken.add(-given, place - pose.point);
  if (step.around.planes[other].PlaneMotion::solid()) taken.press(end_[row.plane].normal.dot(impulse), place - pose.point);
  return given.dot(pose.material_velocity(place));
}

/// Gives pins the impulses of obstacles on the points that they hold: the weights of a sample distribute its impulse to the points.
/// Points of free pins keep the part that moves them. Returns the work of the pins' prescribed motion [J].
double SurfaceContact::give_pins(const StepView& step, const SurfaceStage& stage, double per_force, Exchange& exchange) {
  const Scalars& mass = &stage == &drift_ ? step.kicks.opening_mass() : step.kicks.closing_mass();
  const int n = step.body.points();
  weights_.resize(samples_.support());
  given_.setZero(n, 3);
  const Scalars once = Scalars::Ones(n);
  for (std::size_t t = 0; t < stage.rows.size(); ++t) {
    const int s = stage.rows[t].sample;
    samples_.weights(s, once, weights_.data());
    samples_.add(s, per_force * stage.force(int(t)), weights_.data(), given_);
  }
  double work = 0;
  step.around.visit_pinned(step.t1, [&](const PinnedPoint& held) {
    Vec3 impulse = -row(given_, held.point);
    if (step.around.pins[held.pin].own) impulse += mass[held.point] * (per_force * row(stage.move(), held.point));
    work += pins_.give(step, held, impulse, held.velocity(), exchange);
  });
  return work;
}

/// The impulses J of contact change the kinetic energy by J . w, where w is the mean of the velocities at both ends of the step. If a
/// sample lands, they also move the points within the step, and the forces F work on that motion: over half a step for the drift, over as
/// much less for the closing. Lasting contact balances the part of F that this would count as work, and does none.
double SurfaceContact::loss(const StepView& step, const Points& v1) const {
  if (touching_.empty()) return 0;
  const int n = step.body.points();
  const Scalars &opening = step.kicks.opening_mass(), &closing = step.kicks.closing_mass();
  const Points &move = drift_.move(), &stop = close_.move();
  const double rate = 1 / step.h;
  const PointRange range{std::min(drift_.range().begin, close_.range().begin), std::max(drift_.range().end, close_.range().end)};
  double lost = kernels::energy_taken(n, range, opening.data(), rate, move.data(), closing.data(), stop.data(), start_v_.data(), v1.data());
  for (int axis = 0; lands_ && axis < 3; ++axis)
    for (int p = 0; p < n; ++p) {
      const double more = rate * opening[p] * move(p, axis) - closing[p] * stop(p, axis);
      const double force = 0.5 * (start_force_(p, axis) + step.spring(p, axis) + step.force(p, axis));
      lost += more * 0.5 * step.h * step.body.inverse_mass[p] * force;
    }
  return lost;
}

double SurfaceContact::loss_of_free_pins(const StepView& step, const Points& v1) const {
  double lost = 0;
  if (touching_.empty()) return lost;
  visit_free(step.around, [&](int p) {
    const Vec3 opened = 1 / step.h * row(drift_.move(), p), closed = row(close_.move(), p);
    lost -= 0.5 * step.body.mass[p] * (opened + closed).dot(row(start_v_, p) + row(v1, p));
    if (lands_) lost += 0.25 * step.h * (opened - closed).dot(row(start_force_, p) + row(step.spring, p) + row(step.force, p));
  });
  return lost;
}

}  // namespace softffd
