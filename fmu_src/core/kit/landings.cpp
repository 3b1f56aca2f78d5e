#include "kit/landings.hpp"

#include <algorithm>
#include <cmath>

#include "body/rigid_motion.hpp"
#include "contact/surface/tangents.hpp"
#include "contact/tolerances.hpp"
#include "flight/attitude.hpp"
#include "kit/limits.hpp"
#include "kit/outlook.hpp"
#include "kit/snapshot.hpp"
#include "kit/thresholds.hpp"
#include "model/arithmetic.hpp"

namespace softffd {

namespace thresholds {

/// Largest number of steps of the neighbour for one step of the run at an impact [1].
constexpr double impact_steps = 8;
/// Work of a step in contact relative to a step without contact, as assumed in the forecast of the neighbour's work [1].
constexpr double most_of_contact = 4;
/// Largest number of moves that bring the neighbour out of obstacles when it starts, one obstacle at a time.
constexpr int most_ways_out = 20;
/// A guided obstacle is moved out only if its guide has at least this component along the normal [1].
constexpr double least_cosine_of_guide = 0.1;

}  // namespace thresholds

namespace {

namespace use = thresholds;

Vec3 mean(const Scalars& mass, const Points& x) { return (x.colwise() * mass).colwise().sum().matrix().transpose() / mass.sum(); }

void add(const Vec3& shift, Points& x) {
  for (int axis = 0; axis < 3; ++axis) x.col(axis) += shift[axis];
}

/// Carries the difference of the two bodies on to the end of a flight. The difference turns with the body and drifts with its own rigid
/// part. The mean displacement is turned towards the normal, where it decides when the body lands.
void fly_on(const Model& model, const State& begin, const RigidMotion& rigid, const Vec3& normal, Neighbour& neighbour) {
  const Body& body = model.body;
  const double time = std::min(begin.time - neighbour.off.time, model.longest_lasting());
  const RigidMotion apart = rigid_motion(body.mass, begin.x, neighbour.v);
  const Eigen::Matrix3d turn = rotation_by(time * rigid.spin), swing = rotation_by(time * apart.spin);
  for (int p = 0; p < body.points(); ++p) {
    const Vec3 arm = row(begin.x, p) - apart.centre;
    set_row(neighbour.x, p, time * apart.velocity + swing * (arm + turn * row(neighbour.x, p)) - arm);
    set_row(neighbour.v, p, turn * row(neighbour.v, p));
  }
  const Vec3 whole = mean(body.mass, neighbour.x);
  add(std::copysign(whole.norm(), whole.dot(normal)) * normal - whole, neighbour.x);
}

/// Returns the present state of a free body whose difference from the run's was `apart` this time ago [s].
FreeState fly_beside(const FreeMotion& body, const FreeState& of_run, FreeState apart, double time) {
  apart.position += time * apart.velocity;
  apart.orientation = turned(apart.orientation, time * (body.spin(beside(of_run, apart)) - body.spin(of_run)));
  return beside(of_run, apart);
}

/// Shifts the phase of the vibrations until a point is displaced by `most` [m], but by no more than the vibrations are large.
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

/// Divides the same time into steps that are out of phase with the steps of the run, so that contacts do not begin in the same steps by
/// accident. At a landing the steps are several times shorter: contacts that begin within one step count as simultaneous, and their order
/// decides the result. No step is shorter than the shortest step allowed to the run.
Span out_of_phase(const StepContext& context, const Span& span, bool lands) {
  const double limit = step_limit(context, Method::leapfrog, false);
  const double times = lands ? std::clamp(span.h / shortest_in_contact(context, limit), 1.0, use::impact_steps) : 1;
  const Count steps = Count(times * double(span.steps)) + 1;
  return {span.origin, 0, span.h * double(span.steps) / double(steps), steps};
}

/// Moves the body out of an obstacle, or moves a free obstacle instead. Returns true if something was behind one and could be moved.
bool move_out(const StepContext& context, const NearestObstacle& nearest, Points& x) {
  if (!(nearest.gap < -free_touching * context.model.body.length)) return false;
  const Vec3& normal = nearest.obstacle.normal;
  if (const FreeMotion* free = nearest.plane->own) {
    const Vec3 along = free->body().guided() ? free->body().guide : normal;
    const double cosine = along.dot(normal);
    if (std::abs(cosine) < use::least_cosine_of_guide) return false;
    context.run.physical.motion.free[free->index()].position += nearest.gap / cosine * along;
    return true;
  }
  if (context.drive.held()) return false;
  const Vec3 way = -nearest.gap * normal;
  add(way, x);
  for (const FreeMotion& each : context.drive.free)
    if (each.part()) context.run.physical.motion.free[each.index()].position += way;
  return true;
}

/// Moves the body at x, and free obstacles, out of all. Returns true on success; contact would throw off what starts inside an obstacle.
bool free_of_obstacles(const StepContext& context, State& beside) {
  std::vector<FreeState>& free = context.run.physical.motion.free;
  for (int round = 0; round < use::most_ways_out; ++round) {
    bool moved = false;
    if (!free.empty()) {
      Tangents own(*context.model.body.samples, context.model.body.length);
      if (own.move_out(context.drive, beside.time, free, moved) != StepStatus::ok) return false;
    }
    if (!move_out(context, nearest_obstacle(context, beside), beside.x)) return true;
  }
  return false;
}

/// Starts the neighbour beside the run when a landing begins. beside: scratch.
void set_beside(const StepContext& context, const State& begin, State& beside, double flown) {
  const Body& body = context.model.body;
  Neighbour& neighbour = context.run.control.neighbour;
  const RigidMotion rigid = rigid_motion(body.mass, begin.x, begin.v);
  if (context.drive.pins.empty()) fly_on(context.model, begin, rigid, nearest_obstacle(context, begin).obstacle.normal, neighbour);
  const double vibrations = flown > 0 ? flown : use::least_error * context.request.tolerance;
  const double least = std::max(vibrations, context.run.physical.error.largest());
  if (neighbour.x.abs().maxCoeff() < least) shift_phase(body, begin, rigid, least, neighbour.x);
  beside.time = begin.time;
  beside.x = begin.x + neighbour.x;
  for (const FreeMotion& each : context.drive.free) {
    const FreeState& of_run = begin.free[each.index()];
    FreeState& own = neighbour.free[each.index()];
    own = fly_beside(each, of_run, own, begin.time - neighbour.off.time);
  }
  context.run.physical.motion.free = neighbour.free;
  if (!free_of_obstacles(context, beside)) return neighbour.forget();
  neighbour.x = beside.x;
  neighbour.v += begin.v;
  neighbour.free = context.run.physical.motion.free;
  neighbour.follows = true;
  neighbour.landed = false;
  neighbour.began = begin.time;
}

/// What remains of a difference of velocities if the body stays on its obstacle: the part along it, until friction stops the body or the
/// run ends.
Drift sliding_apart(const StepContext& context, const Vec3& velocity) {
  const State& motion = context.run.physical.motion;
  const Outlook ahead = outlook(context, motion);
  const NearestObstacle nearest = nearest_obstacle(context, motion);
  const RigidMotion rigid = rigid_motion(context.model.body.mass, motion.x, motion.v);
  const double speed = tangential(ahead.normal, velocity).norm(), grip = nearest.plane->friction * ahead.pressing;
  if (ahead.slides_on() || !(grip > 0)) return {.speed = speed};
  const double slip = tangential(ahead.normal, rigid.velocity - nearest.obstacle.material_velocity(rigid.centre)).norm();
  return {.place = speed * std::min(slip / grip, left_of_run(context))};
}

/// True if vertices may skip along a solid without another landing (`in_flight`).
bool skips(const StepContext& context) {
  const auto solid = [](const Plane& each) { return each.solid(); };
  return context.model.body.dashpots() && !context.drive.held() && std::ranges::any_of(context.drive.planes, solid);
}

}  // namespace

bool Landings::landing(const StepContext& context, double time) {
  const Neighbour& neighbour = context.run.control.neighbour;
  return neighbour.follows && time - neighbour.impact <= slowest_period(context);
}

bool Landings::lands(const StepContext& context, double time, bool impact) {
  const Neighbour& neighbour = context.run.control.neighbour;
  return impact && !(neighbour.follows && time - neighbour.began > slowest_period(context));
}

void Landings::follow(Integrators& integrators, const StepContext& context, const State& begin, Method method, const Span& span,
                      bool impact, double flown, bool anyway) {
  PhysicalState& physical = context.run.physical;
  Neighbour& neighbour = context.run.control.neighbour;
  if (neighbour.follows && neighbour.off.time != begin.time) neighbour.forget();  // other steps came between
  const bool goes_on = neighbour.follows && (!skips(context) || landing(context, begin.time));
  if (impact && !goes_on) {
    std::vector<FreeState> end = begin.free;  // free obstacles where they were at the start
    end.swap(physical.motion.free);
    if (anyway || in_flight(context, begin.time, begin.x)) {
      if (neighbour.follows)
        neighbour.began = begin.time;
      else
        set_beside(context, begin, physical_.motion, flown);
    }
    end.swap(physical.motion.free);
  }
  if (!neighbour.follows) return;
  const Span own = method == Method::leapfrog ? out_of_phase(context, span, lands(context, begin.time, impact)) : span;
  const double work = use::most_of_contact * double(own.steps) * step_work(context.model.body, context.drive, context.run, method, own.h);
  if (!integrators.budget().covers(work)) return neighbour.forget();
  if (impact && (goes_on || neighbour.began == begin.time)) neighbour.impact = physical.motion.time;
  Snapshot snapshot(physical, physical_);
  physical.motion.x = neighbour.x;
  physical.motion.v = neighbour.v;
  physical.motion.free = neighbour.free;
  physical.motion.time = begin.time;
  context.model.body.internal_force(physical.motion.x, physical.motion.spring);
  const Outcome outcome = integrators.take(context, method, own);
  neighbour.x = physical.motion.x;
  neighbour.v = physical.motion.v;
  neighbour.free = physical.motion.free;
  neighbour.landed = neighbour.landed || outcome.impacts > 0;
  const bool alone = in_flight(context, physical.motion.time, physical.motion.x);
  snapshot.rollback();
  snapshot.commit();
  const Points& x = physical.motion.x;
  const double place = (neighbour.x - x).abs().maxCoeff();
  if (outcome.status != StepStatus::ok || !std::isfinite(place)) return neighbour.forget();
  neighbour.off = {place, 0, physical.motion.time};
  for (const FreeMotion& each : context.drive.free) {
    const std::size_t k = each.index();
    neighbour.off.place = worse(neighbour.off.place, free_apart(context, each, physical.motion.free[k], neighbour.free[k]).place);
  }
  const bool flies = alone && in_flight(context, physical.motion.time, x);
  const bool over = !landing(context, physical.motion.time);
  if (flies ? neighbour.landed || over : over && !skips(context)) part(context, flies);
}

void Landings::part(const StepContext& context, bool flies) {
  const Body& body = context.model.body;
  const State& motion = context.run.physical.motion;
  Neighbour& neighbour = context.run.control.neighbour;
  neighbour.x -= motion.x;
  neighbour.v -= motion.v;
  neighbour.follows = false;
  for (const FreeMotion& each : context.drive.free) {
    const FreeState& of_run = motion.free[each.index()];
    FreeState& own = neighbour.free[each.index()];
    const auto [place, speed] = free_apart(context, each, of_run, own);
    if (flies)
      neighbour.off.speed = std::max(neighbour.off.speed, speed);
    else
      neighbour.off.place = std::max(neighbour.off.place, swing_time(context, each) * speed);
    own = difference(of_run, own);
  }
  if (std::ranges::any_of(context.drive.free, &FreeMotion::part)) return neighbour.forget();  // a difference would tear the part off
  if (!context.drive.pins.empty()) return;
  const RigidMotion apart = rigid_motion(body.mass, motion.x, neighbour.v);
  if (flies) {
    const double speed = apart.velocity.norm() + radius_about(apart.centre, motion.x) * apart.spin.norm();
    neighbour.off.speed = std::max(neighbour.off.speed, speed);
    return;
  }
  const Drift slides = sliding_apart(context, apart.velocity);
  neighbour.off.place += slides.place;
  neighbour.off.speed = std::max(neighbour.off.speed, slides.speed);
  for (int p = 0; p < body.points(); ++p)
    set_row(neighbour.v, p, row(neighbour.v, p) - apart.velocity - apart.spin.cross(row(motion.x, p) - apart.centre));
}

}  // namespace softffd
