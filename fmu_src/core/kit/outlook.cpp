#include "kit/outlook.hpp"

#include <algorithm>
#include <cmath>

#include "contact/broad_phase.hpp"
#include "contact/surface/tangents.hpp"
#include "contact/tolerances.hpp"
#include "kit/thresholds.hpp"
#include "methods/traits.hpp"
#include "model/arithmetic.hpp"

namespace softffd {

namespace thresholds {

// Steps are the largest stable explicit steps; kit/thresholds.hpp says what these values rest on.

/// Period of the slowest vibration in units of the largest time scale of a point [1]: for the uniform lattice of four points a side.
constexpr double period_per_time_scale = 26;
/// The rest of a run counts as at least this fraction of the run [1].
constexpr double least_left = 0.02;
/// Periods of the slowest vibration that a difference of velocities lasts at least, unless internal damping takes it sooner.
constexpr double memory_periods = 10;
/// An acceleration towards an obstacle is rounding if it is at most this fraction of the acceleration by outside forces [1].
constexpr double least_pressing = 1e-6;
/// Two obstacles hold a body from two sides if the cosine of the angle between their normals is below this [1].
constexpr double opposite = -0.5;
/// Fraction of the speed of turning that counts in the speed of approach, because the next rebound may feel it [1].
constexpr double turning_fraction = 0.3;
/// Fraction of the vibrations' velocity that the next rebound may feel if a sample of the surface strikes: the sample stops at once, and
/// with it the mass that moves with it [1].
constexpr double struck_fraction = 0.5;
/// Gap relative to the box up to which a ringing body counts as touching in the check for a fall [1]; logarithm of the largest growth.
constexpr double snug = 1e-4, longest_growth = 20;
/// Distance from the hinge, relative to the box, up to which a pinned point counts as on it [1].
constexpr double on_hinge = 1e-9;

}  // namespace thresholds

namespace {

namespace use = thresholds;
/// Speed that is added to every speed of approach [m/s].
constexpr double standstill = 1e-9;

/// How long a velocity of the whole body lasts at most [s]: to the end of the run, or until drag has taken it. Free bodies are not dragged,
/// and may take the velocity over.
double lasting(const StepContext& context) {
  const double left = left_of_run(context);
  return context.drive.free.empty() ? std::min(left, context.model.longest_lasting()) : left;
}

/// Acceleration that the outside forces give the whole body [m/s2].
Vec3 whole_acceleration(const StepContext& context) {
  const double t = context.run.physical.motion.time;
  Vec3 sum = Vec3::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    sum[axis] = context.drive.force.col(axis).sum();
    if (context.drive.ramped)
      for (Eigen::Index p = 0; p < context.drive.force.rows(); ++p)
        sum[axis] += context.drive.ramp(p + axis * context.drive.force.rows(), t);
  }
  return sum / context.model.body.mass.sum();
}

/// Acceleration of an obstacle, as the body feels it in the obstacle's frame [m/s2]: where the obstacle turns, with the accelerations of
/// the place of the body's centre and of Coriolis. Of a free obstacle, its acceleration in flight.
Vec3 acceleration_of(const Plane& obstacle, const HalfSpace& now, const Body& body, const State& state) {
  if (obstacle.own) return obstacle.own->acceleration(state.free[obstacle.own->index()]);
  if (!obstacle.bends()) return obstacle.acceleration;
  const RigidMotion motion = rigid_motion(body.mass, state.x, state.v);
  const Vec3 arm = motion.centre - now.point, moved = motion.velocity - now.velocity;
  return obstacle.acceleration + obstacle.angular_acceleration.cross(arm) + now.spin.cross(2 * moved - now.spin.cross(arm));
}

/// True if obstacles hold the body from two sides.
bool squeezed(const StepContext& context, const State& state) {
  const double touch = touching * context.model.body.length;
  const auto touches = [&](const HalfSpace& obstacle) { return least_gap(context.model.body, obstacle, state.x) <= touch; };
  const auto& planes = context.drive.planes;
  const Vec3 middle = state.x.colwise().mean().matrix().transpose();
  for (std::size_t a = 0; a < planes.size(); ++a)
    for (std::size_t b = a + 1; b < planes.size(); ++b) {
      const HalfSpace one = facing_half_space(planes[a], state.time, middle), other = facing_half_space(planes[b], state.time, middle);
      if (one.normal.dot(other.normal) < use::opposite && touches(one) && touches(other)) return true;
    }
  return false;
}

/// Time in which internal damping takes a vibration of this period, or a creeping motion, to 1 / e [s]; infinite without dashpots.
double decay_time(const StepContext& context, double period) {
  const double time = context.model.body.shortest_time();
  constexpr double two_pi = 6.283185307179586;
  return time > 0 ? std::max(2 * power(period / two_pi, 2) / time, time) : infinity;
}

/// How long a velocity of the body in contact lasts, if its slowest vibration has this period [s]. Internal damping may take it sooner.
double ringing_time(const StepContext& context, double period) {
  return std::min(use::memory_periods * period, period + decay_time(context, period));
}

/// Calls visit(place) for all places that may touch: control points, or the surface's samples.
template <class Visit>
void visit_places(const Body& body, const Points& x, Visit visit) {
  if (!body.samples) {
    for (int p = 0; p < body.points(); ++p) visit(row(x, p));
    return;
  }
  for (int s = 0; s < body.samples->count(); ++s) visit(body.samples->at(s, x));
}

/// Checks whether the body falls over: whether all touching places lie on one side of the point where the outside force through the centre
/// meets the obstacle. The body then turns about the touching places until another place comes down. The difference of two such motions
/// grows as their speed does, from rest exponentially.
void look_for_fall(const StepContext& context, const State& state, Outlook& ahead) {
  const Body& body = context.model.body;
  const RigidMotion motion = rigid_motion(body.mass, state.x, state.v);
  const auto [plane, obstacle, gap] = nearest_obstacle(context, state);
  const double snug = use::snug * body.length, height = obstacle.gap(motion.centre);
  Vec3 pull = tangential(ahead.normal, whole_acceleration(context) - acceleration_of(*plane, obstacle, body, state));
  const double most = plane->friction * ahead.pressing;
  if (pull.norm() > most) pull *= most / pull.norm();
  const Vec3 aim = motion.centre + height / ahead.pressing * pull;
  Vec3 support = Vec3::Zero();
  int count = 0;
  visit_places(body, state.x, [&](const Vec3& place) {
    if (obstacle.gap(place) > snug) return;
    support += place;
    ++count;
  });
  if (count == 0 || !(height > 0)) return;
  support /= count;
  Vec3 way = tangential(ahead.normal, aim - support);
  if (!(way.norm() > snug)) return;
  way.normalize();
  double beyond = -infinity, land = infinity;  // tangent of the angle until a place lands
  visit_places(body, state.x, [&](const Vec3& place) {
    const double above = obstacle.gap(place), on = way.dot(place - support);
    if (above <= snug)
      beyond = std::max(beyond, way.dot(place - aim));
    else if (on > 0)
      land = std::min(land, above / on);
  });
  if (!(beyond < -snug)) return;
  const Vec3 axis = ahead.normal.cross(way), arm = motion.centre - support;
  const double squared = arm.squaredNorm() + 1 / (motion.mass * axis.dot(motion.inverse_inertia * axis));
  const double cosine = 1 / std::sqrt(1 + land * land), sine = land < infinity ? land * cosine : 1;
  const double drop = height * (1 - cosine) + way.dot(arm) * sine;
  const double spin = axis.dot(motion.spin - obstacle.spin), energy = squared * spin * spin;
  const double rate = std::sqrt(ahead.pressing * arm.norm() / squared), lasts = std::min(ahead.left, 1 / rate);
  const double slow = power(1 + std::min(use::longest_growth, ahead.left * rate) / 1024, 1024);  // exp, the same bits everywhere
  const double fast = energy > 0 ? std::sqrt(1 + 2 * ahead.pressing * std::max(drop, 0.0) / energy) : infinity;
  ahead.growth = std::min(slow, fast);
  ahead.along_normal = std::max(ahead.along_normal, lasts);
  ahead.along_plane = std::max(ahead.along_plane, lasts);
  ahead.sweep = 2 * radius_about(motion.centre, state.x) * sine;
}

}  // namespace

double left_of_run(const StepContext& context) {
  const double horizon = context.request.horizon, time = context.run.physical.motion.time;
  return time < horizon ? std::max(horizon - time, use::least_left * horizon) : horizon;
}

/// The lowest frequency of the uniform lattice is inversely proportional to its number of points along the longest side.
double slowest_period(const StepContext& context) {
  const int n = context.model.body.points();
  double longest = 0;
  for (int i = 0; i < 3 * n; ++i)
    if (!context.model.body.pinned[i % n]) longest = std::max(longest, context.model.time_scale[i]);
  return std::min(use::period_per_time_scale * longest, left_of_run(context));
}

double vibration_lasts(const StepContext& context) {
  return std::min(0.5 * decay_time(context, slowest_period(context)), context.model.longest_lasting());
}

NearestObstacle nearest_obstacle(const StepContext& context, const State& state) {
  NearestObstacle nearest;
  for (const Plane& plane : context.drive.planes) {
    const Facing here = facing(context.model.body, plane, state.time, state.x);
    if (!nearest.plane || !(here.gap >= nearest.gap)) nearest = {&plane, here.obstacle, here.gap};
  }
  return nearest;
}

bool in_flight(const StepContext& context, double time, const Points& x) {
  const Body& body = context.model.body;
  const double skip = body.dashpots() ? use::least_error * context.request.tolerance : 0;
  return off_obstacles(body, context.drive, time, x, touching * body.length, skip);
}

double pressed_since(const StepContext& context, const std::vector<Impulse>& before) {
  const std::vector<Impulse>& now = context.run.physical.exchange.planes;
  double most = 0;
  for (std::size_t q = 0; q < now.size(); ++q) {
    const Plane& obstacle = context.drive.planes[q];
    const Vec3 force = now[q].force - before[q].force;
    most = std::max(most, std::abs(obstacle.solid() ? now[q].pressed - before[q].pressed
                                                    : force.dot(obstacle.at(context.run.physical.motion.time).normal)));
  }
  return most;
}

double kinetic_deformation(const Body& body, const State& state) {
  const RigidMotion motion = rigid_motion(body.mass, state.x, state.v);
  double energy = 0;
  for (int p = 0; p < body.points(); ++p) {
    const Vec3 own = row(state.v, p) - motion.velocity - motion.spin.cross(row(state.x, p) - motion.centre);
    energy += 0.5 * body.mass[p] * own.squaredNorm();
  }
  return energy;
}

double approach_speed(const StepContext& context, const State& state, const RigidMotion& rigid, double radius) {
  const HalfSpace obstacle = nearest_obstacle(context, state).obstacle;
  const Vec3 velocity = rigid.velocity - obstacle.material_velocity(rigid.centre);
  return std::abs(velocity.dot(obstacle.normal)) + use::turning_fraction * radius * (rigid.spin - obstacle.spin).norm() + standstill;
}

Outlook outlook(const StepContext& context, const State& state) {
  const auto [plane, obstacle, gap] = nearest_obstacle(context, state);
  const Vec3 outside = whole_acceleration(context), pushed = acceleration_of(*plane, obstacle, context.model.body, state) - outside;
  const double left = lasting(context), towards = pushed.dot(obstacle.normal);
  const double pressing = std::abs(towards) > use::least_pressing * outside.norm() ? towards : 0;  // body and obstacle may fall alike
  Outlook ahead{obstacle.normal, left, left, left, pressing};
  if (context.drive.held()) return ahead;
  if (squeezed(context, state)) {
    ahead.along_normal = std::min(left, ringing_time(context, slowest_period(context)));
    if (plane->friction > 0) ahead.along_plane = ahead.along_normal;
    return ahead;
  }
  if (!(pressing > 0)) return ahead;
  ahead.drive = tangential(obstacle.normal, pushed).norm();
  ahead.grip = plane->friction * pressing;
  const Body& body = context.model.body;
  const RigidMotion motion = rigid_motion(body.mass, state.x, state.v);
  const double radius = radius_about(motion.centre, state.x), period = slowest_period(context);
  const Vec3 velocity = motion.velocity - obstacle.material_velocity(motion.centre), spin = motion.spin - obstacle.spin;
  const double across = std::abs(velocity.dot(obstacle.normal)) + radius * tangential(obstacle.normal, spin).norm() +
                        std::sqrt(4 * kinetic_deformation(body, state) / motion.mass);
  const Vec3 slip = tangential(obstacle.normal, velocity);
  const double along = slip.norm() + radius * spin.norm();
  ahead.along_normal = std::min(left, std::max(ringing_time(context, period), 4 * across / pressing));
  if (slip.norm() > plane->friction * across + radius * spin.norm()) ahead.rub = -plane->friction * slip.normalized();
  const double sliding = plane->friction > 0 ? 2 * along / (plane->friction * pressing) : infinity;
  ahead.along_plane = std::min(left, std::max(ahead.along_normal, sliding));
  return ahead;
}

Outlook outlook_of_stiff(const StepContext& context, const State& state) {
  Outlook ahead = outlook(context, state);
  if (!context.drive.held() && ahead.pressing > 0) look_for_fall(context, state, ahead);
  return ahead;
}

/// A position error e shifts the time of contact by e / v, the phase of the vibration by omega e / v, and the rebound by a fraction of the
/// vibration's velocity.
void book_unknown_phase(const StepContext& context, const State& state, double energy, double frequency, double known) {
  StiffContact& stiff = context.run.physical.stiff;
  const RigidMotion rigid = rigid_motion(context.model.body.mass, state.x, state.v);
  const double error = std::max(known, use::least_error * context.request.tolerance);
  const double phase = std::min(1.0, frequency * error / approach_speed(context, state, rigid, radius_about(rigid.centre, state.x)));
  const double fraction = context.model.body.samples ? use::struck_fraction : use::rebound_fraction;
  const double added = fraction * std::sqrt(2 * energy / rigid.mass) * phase * outlook(context, state).along_plane;
  stiff.unknown = std::sqrt(power(stiff.unknown, 2) + power(added, 2));
}

FreeApart free_apart(const StepContext& context, const FreeMotion& body, const FreeState& a, const FreeState& b) {
  const int q = body.body().plane;
  const double size = q >= 0 ? context.drive.planes[q].size() : context.model.body.length;
  return {(a.position - b.position).norm() + size * (axes_of(a.orientation) - axes_of(b.orientation)).norm(),
          (a.velocity - b.velocity).norm() + size * (body.spin(a) - body.spin(b)).norm()};
}

double swing_time(const StepContext& context, const FreeMotion& body) {
  const double period = slowest_period(context) * std::sqrt(1 + body.mass() / context.model.body.mass.sum());
  return std::min(period, left_of_run(context));
}

double free_bodies_apart(const StepContext& context, const State& a, const State& b, bool swing) {
  const PhysicalState& physical = context.run.physical;
  const std::vector<Count>& rows = is_implicit(context.run.control.method) ? physical.motion.held_rows.rows : physical.surface.drift;
  const bool touches = swing || (!rows.empty() && rows.front() >= 0);
  const double left = left_of_run(context);
  double most = 0;
  for (const FreeMotion& each : context.drive.free) {
    const auto [place, speed] = free_apart(context, each, a.free[each.index()], b.free[each.index()]);
    const bool lasts = touches || (each.part() && context.drive.held());
    most = worse(most, std::max(place, speed * (lasts ? swing_time(context, each) : left)));
  }
  return most;
}

namespace {

/// Returns the displacement of a body from one place to another, as velocity and spin of a motion of one second.
RigidMotion way_between(const Scalars& mass, const Points& from, const Points& to) {
  RigidMotion way = rigid_motion(mass, from, to);
  const RigidMotion rest = rigid_motion(mass, from, from);
  way.velocity -= rest.velocity;
  way.spin -= rest.spin;
  return way;
}

/// Fraction of a velocity difference that has moved the body within the sub-interval.
double moved(const Vec3& velocity, const Vec3& way, double stretch) {
  const double speed = velocity.norm(), lasting = use::way_of_velocity * way.norm() / stretch;
  return lasting < speed ? lasting / speed : 1;
}

/// Difference of the rigid motions of two states, and its part along the obstacle after the obstacle has taken the part across [m/s].
struct Parting {
  double radius;  ///< of the outermost point [m]
  Vec3 velocity, spin, along, lasting;
  /// stretch: time that led to both states [s], if a velocity is to count only as far as it has moved the body; else 0.
  Parting(const Body& body, const State& a, const State& b, const Outlook& ahead, double stretch = 0) {
    const RigidMotion of_a = rigid_motion(body.mass, a.x, a.v), of_b = rigid_motion(body.mass, b.x, b.v);
    radius = radius_about(of_b.centre, b.x);
    velocity = of_a.velocity - of_b.velocity;
    spin = of_a.spin - of_b.spin;
    if (stretch > 0) {
      const RigidMotion way = way_between(body.mass, b.x, a.x);
      velocity *= moved(velocity, way.velocity, stretch);
      spin *= moved(spin, way.spin, stretch);
    }
    along = tangential(ahead.normal, velocity);
    lasting = along - velocity.dot(ahead.normal) * ahead.rub;
  }
};

}  // namespace

double lasting_part(const StepContext& context, const State& a, const State& b, const Outlook& ahead, double size) {
  if (!context.drive.free.empty() || ahead.growth > 1 || !(ahead.along_normal < ahead.left) || !(size < infinity)) return size;
  const Parting apart(context.model.body, a, b, ahead);
  const Scalars& mass = context.model.body.mass;
  const RigidMotion way = way_between(mass, b.x, a.x);
  const double place = tangential(ahead.normal, way.velocity).norm() + apart.radius * std::abs(way.spin.dot(ahead.normal));
  const double grown = ahead.along_plane * (apart.lasting.norm() + apart.radius * std::abs(apart.spin.dot(ahead.normal)));
  return std::min(size, place + grown);
}

namespace {

/// Largest way [m] by which two states of a body will differ at the end of the run because they swing differently, if pins hold the body
/// at one point or on a line, about which it swings freely; else 0.
double swung_apart(const StepContext& context, const State& a, const State& b) {
  const Body& body = context.model.body;
  const std::vector<bool>& held = body.prescribed();  // points that a free part carries move with it
  int first = -1, last = -1;
  double length = 0;
  for (int p = 0; p < body.points(); ++p) {
    if (!held[p]) continue;
    if (first < 0) first = p;
    if (const double from_first = (row(b.x, p) - row(b.x, first)).norm(); from_first >= length) last = p, length = from_first;
  }
  if (first < 0) return 0;
  const Vec3 hinge = row(b.x, first), axis = length > 0 ? Vec3((row(b.x, last) - hinge) / length) : Vec3::Zero();
  const auto arm = [&](int p) { return Vec3(row(b.x, p) - hinge - axis.dot(row(b.x, p) - hinge) * axis); };
  Vec3 momentum = Vec3::Zero();
  double inertia = 0, radius = 0;
  for (int p = 0; p < body.points(); ++p) {
    const Vec3 from_hinge = arm(p);
    if (held[p] && from_hinge.norm() > use::on_hinge * body.length) return 0;
    momentum += body.mass[p] * from_hinge.cross(row(a.v, p) - row(b.v, p));
    inertia += body.mass[p] * from_hinge.squaredNorm();
    radius = std::max(radius, from_hinge.norm());
  }
  const Vec3 spin = (length > 0 ? Vec3(axis.dot(momentum) * axis) : momentum) / inertia;
  return radius * spin.norm() * lasting(context);
}

}  // namespace

FinalError final_error(const StepContext& context, const State& a, const State& b, const Outlook& ahead, double stretch) {
  const Body& body = context.model.body;
  double error = free_bodies_apart(context, a, b, false);
  for (int i = 0; i < a.x.size(); ++i)
    if (context.model.memory[i] > 0) error = worse(error, std::abs(a.x.data()[i] - b.x.data()[i]));
  if (context.drive.held()) {
    for (int i = 0; i < a.v.size(); ++i) error = std::max(error, std::abs(a.v.data()[i] - b.v.data()[i]) * context.model.time_scale[i]);
    error = worse(error, swung_apart(context, a, b));
    if (std::isnan(error)) error = infinity;
    return {.size = error, .lag = error};
  }
  const auto [radius, velocity, spin, along, lasting] = Parting(body, a, b, ahead, stretch);
  const Vec3 across = velocity - along, over = tangential(ahead.normal, spin);
  const double grown = ahead.along_plane * (lasting.norm() + radius * std::abs(spin.dot(ahead.normal))) +
                       ahead.along_normal * (across.norm() + (along - lasting).norm() + radius * over.norm());
  if (!(error < infinity && grown < infinity)) return {infinity};
  const double now = std::max(error, grown), size = std::min(ahead.growth * now, now + ahead.sweep), growth = now > 0 ? size / now : 1;
  if (body.dashpots()) return {size};  // a coarser run lags by the same amount again and again, which does not add up
  return {size, 0, growth * (ahead.along_plane * lasting + ahead.along_normal * (velocity - lasting)),
          growth * radius * (ahead.along_plane * (spin - over) + ahead.along_normal * over)};
}

}  // namespace softffd
