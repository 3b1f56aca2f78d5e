#include "stepping/landings.hpp"

#include <algorithm>
#include <cmath>

#include "body/rigid_motion.hpp"
#include "contact/broad_phase.hpp"
#include "contact/tolerances.hpp"
#include "flight/attitude.hpp"
#include "kit/outlook.hpp"
#include "kit/snapshot.hpp"
#include "kit/thresholds.hpp"
#include "model/arithmetic.hpp"

namespace softffd {

namespace thresholds {

/// Of the neighbour for one of the path at an impact [1].
constexpr Count impact_steps = 8;

}  // namespace thresholds

namespace {

namespace use = thresholds;

bool off_obstacles(const StepContext& context, double time, const Points& x) {
  return off_obstacles(context.model.body, context.drive, time, x, touching * context.model.body.length);
}

Vec3 mean(const Scalars& mass, const Points& x) { return (x.colwise() * mass).colwise().sum().matrix().transpose() / mass.sum(); }

void add(const Vec3& shift, Points& x) {
  for (int axis = 0; axis < 3; ++axis) x.col(axis) += shift[axis];
}

/// Moves what the bodies differ by on to the end of a flight. The rigid part turns with the body, and its place along the normal, where it
/// decides when the body lands.
void fly_on(const Body& body, const State& begin, const RigidMotion& rigid, const Vec3& normal, Neighbour& neighbour) {
  const double time = begin.time - neighbour.off.time;
  const RigidMotion apart = rigid_motion(body.mass, begin.x, neighbour.v);
  const Eigen::Matrix3d turn = rotation_by(time * rigid.spin);
  for (int p = 0; p < body.points(); ++p) {
    const Vec3 way = time * (apart.velocity + apart.spin.cross(row(begin.x, p) - apart.centre));
    set_row(neighbour.x, p, turn * row(neighbour.x, p) + way);
    set_row(neighbour.v, p, turn * row(neighbour.v, p));
  }
  const Vec3 whole = mean(body.mass, neighbour.x);
  add(std::copysign(whole.norm(), whole.dot(normal)) * normal - whole, neighbour.x);
}

/// Moves vibrations on in their phase until a place is off by so much [m], though not by more than they are large.
void shift_phase(const Body& body, const State& begin, const RigidMotion& rigid, double most, Points& x) {
  double squares = 0, fastest = 0;
  for (int i = 0; i < begin.spring.size(); ++i) squares += body.inverse_mass[i] * power(begin.spring.data()[i], 2);
  const auto own = [&](int p) {
    return body.pinned[p] ? Vec3(Vec3::Zero()) : Vec3(row(begin.v, p) - rigid.velocity - rigid.spin.cross(row(begin.x, p) - rigid.centre));
  };
  for (int p = 0; p < body.points(); ++p) fastest = std::max(fastest, own(p).norm());
  if (!(squares > 0 && fastest > 0)) return;
  const double time = std::min(most / fastest, std::sqrt(2 * body.elastic_energy(begin.x) / squares));
  for (int p = 0; p < body.points(); ++p) set_row(x, p, row(x, p) + time * own(p));
}

/// The same time in steps that are out of phase with the path's: what comes onto an obstacle in which step is then not the same by
/// accident. At an impact they are many times shorter: what comes within a step is taken to come at once, and which place comes first
/// decides.
Span out_of_phase(const Span& span, bool impact) {
  const Count steps = (impact ? use::impact_steps : 1) * span.steps + 1;
  return {span.origin, 0, span.h * double(span.steps) / double(steps), steps};
}

/// A landing begins: the neighbour goes on from beside the path. beside: scratch.
void set_beside(const StepContext& context, const State& begin, State& beside) {
  const Body& body = context.model.body;
  Neighbour& neighbour = context.run.course.neighbour;
  const RigidMotion rigid = rigid_motion(body.mass, begin.x, begin.v);
  if (context.drive.pins.empty()) fly_on(body, begin, rigid, nearest_obstacle(context, begin).obstacle.normal, neighbour);
  const double least = use::least_error * context.request.tolerance;
  if (neighbour.x.abs().maxCoeff() < least) shift_phase(body, begin, rigid, least, neighbour.x);
  beside.time = begin.time;
  beside.x = begin.x + neighbour.x;
  const NearestObstacle nearest = nearest_obstacle(context, beside);
  if (nearest.gap < 0 && context.drive.pins.empty()) add(-nearest.gap * nearest.obstacle.normal, beside.x);
  neighbour.x = beside.x;
  neighbour.free = begin.free;
  neighbour.v += begin.v;
  neighbour.follows = true;
}

/// What is left of a difference of velocities where the body stays on its obstacle: along it, until friction has stopped the body.
Drift sliding_apart(const StepContext& context, const Vec3& velocity) {
  const State& motion = context.run.path.motion;
  const Outlook ahead = outlook(context, motion);
  const NearestObstacle nearest = nearest_obstacle(context, motion);
  const RigidMotion rigid = rigid_motion(context.model.body.mass, motion.x, motion.v);
  const double speed = tangential(ahead.normal, velocity).norm(), grip = nearest.plane->friction * ahead.pressing;
  if (ahead.slides_on || !(grip > 0)) return {.speed = speed};
  return {.place = speed * tangential(ahead.normal, rigid.velocity - nearest.obstacle.material_velocity(rigid.centre)).norm() / grip};
}

}  // namespace

void Landings::follow(Integrators& integrators, const StepContext& context, const State& begin, Method method, const Span& span,
                      bool impact) {
  Path& path = context.run.path;
  Neighbour& neighbour = context.run.course.neighbour;
  if (neighbour.follows && neighbour.off.time != begin.time) neighbour.forget();  // other steps came between
  if (!neighbour.follows) {
    if (!impact || !off_obstacles(context, begin.time, begin.x)) return;
    set_beside(context, begin, path_.motion);
  }
  if (impact) neighbour.impact = path.motion.time;
  Snapshot snapshot(path, path_);
  path.motion.x = neighbour.x;
  path.motion.v = neighbour.v;
  path.motion.free = neighbour.free;
  path.motion.time = begin.time;
  context.model.body.internal_force(path.motion.x, path.motion.spring);
  const Outcome outcome = integrators.take(context, method, method == Method::leapfrog ? out_of_phase(span, impact) : span);
  neighbour.x = path.motion.x;
  neighbour.v = path.motion.v;
  neighbour.free = path.motion.free;
  snapshot.rollback();
  snapshot.commit();
  const Points& x = path.motion.x;
  const double place = (neighbour.x - x).abs().maxCoeff();
  if (outcome.status != StepStatus::ok || !std::isfinite(place)) return neighbour.forget();
  neighbour.off = {place, 0, path.motion.time};
  const bool flies = off_obstacles(context, path.motion.time, x) && off_obstacles(context, path.motion.time, neighbour.x);
  if (flies || path.motion.time - neighbour.impact > slowest_period(context)) part(context, flies);
}

/// They no longer take the same steps: what they differ by is kept.
void Landings::part(const StepContext& context, bool flies) {
  const Body& body = context.model.body;
  const State& motion = context.run.path.motion;
  Neighbour& neighbour = context.run.course.neighbour;
  neighbour.x -= motion.x;
  neighbour.v -= motion.v;
  neighbour.follows = false;
  if (!context.drive.pins.empty()) return;
  const RigidMotion apart = rigid_motion(body.mass, motion.x, neighbour.v);
  if (flies) {
    neighbour.off.speed = apart.velocity.norm() + radius_about(apart.centre, motion.x) * apart.spin.norm();
    return;
  }
  const Drift slides = sliding_apart(context, apart.velocity);
  neighbour.off.place += slides.place;
  neighbour.off.speed = slides.speed;
  for (int p = 0; p < body.points(); ++p)
    set_row(neighbour.v, p, row(neighbour.v, p) - apart.velocity - apart.spin.cross(row(motion.x, p) - apart.centre));
}

}  // namespace softffd
