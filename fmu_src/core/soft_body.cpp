#include "soft_body.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "model/arithmetic.hpp"
#include "model/rigid_motion.hpp"

namespace softffd {

namespace {

/// Displacements relative to the box that are rounding.
constexpr double slight = 1e-9;
/// A change of the outside forces by this share of their size between two communication steps is a jolt.
constexpr double jolt_share = 0.01;

std::vector<bool> mask(const std::vector<int>& points, int count) {
  std::vector<bool> selected(count, false);
  for (int p : points) selected[p] = true;
  return selected;
}

std::vector<StiffnessOverride> stiffness_overrides(const Definition& definition) {
  std::vector<StiffnessOverride> overrides;
  for (const Region& region : definition.regions)
    if (region.stiffness) overrides.push_back({mask(region.points, definition.lattice.points()), *region.stiffness});
  return overrides;
}

std::vector<bool> pinned_points(const Definition& definition) {
  std::vector<bool> pinned(definition.lattice.points(), false);
  for (const PinDefinition& pin : definition.pins)
    for (int p : pin.points) pinned[p] = true;
  return pinned;
}

Pin make_pin(const Definition& definition, const PinDefinition& source, Vec3& origin) {
  const Points rest = rest_positions(definition.lattice);
  Pin pin;
  pin.points = source.points;
  origin.setZero();
  for (int p : source.points) origin += row(rest, p) / double(source.points.size());
  for (int p : source.points) pin.local.push_back(row(rest, p) - origin);
  return pin;
}

bool finite(const Progress& progress) {
  const State& motion = progress.motion;
  const auto sound = [H = progress.exchange_time](const Impulse& impulse) {
    return (impulse.force / H).allFinite() && (impulse.torque / H).allFinite();
  };
  const auto& exchange = progress.exchange;
  return motion.x.allFinite() && motion.v.allFinite() && motion.spring.allFinite() && std::isfinite(progress.potential) &&
         std::isfinite(progress.watch.kinetic_elastic) && std::isfinite(progress.work) && std::isfinite(progress.dissipated) &&
         !std::isnan(progress.course.bound) && std::isfinite(exchange.work) && std::isfinite(exchange.dissipated) &&
         std::all_of(exchange.planes.begin(), exchange.planes.end(), sound) &&
         std::all_of(exchange.pins.begin(), exchange.pins.end(), sound);
}

}  // namespace

Points start_positions(const Definition& definition) {
  const Lattice& lattice = definition.lattice;
  Points x = rest_positions(lattice);
  for (int p = 0; p < lattice.points(); ++p)
    set_row(x, p, lattice.origin + definition.stretch.cwiseProduct(row(x, p) - lattice.origin) + definition.offset);
  return x;
}

SoftBody::SoftBody(Definition definition)
    : definition_(std::move(definition)),
      body_{.springs = Springs(definition_.lattice, definition_.topology), .mass = {}, .damping = {}, .pinned = pinned_points(definition_)},
      overrides_(stiffness_overrides(definition_)),
      cells_(definition_.lattice),
      propagator_(definition_.lattice, definition_.planes, int(definition_.pins.size())),
      jumps_(definition_.lattice.points(), definition_.planes) {
  const int n = definition_.lattice.points();
  body_.mass = Eigen::Map<const Scalars>(definition_.mass.data(), n);
  body_.damping = Scalars::Zero(n);
  body_.length = definition_.lattice.largest_side();
  if (definition_.volume_stiffness > 0) body_.volume.emplace(definition_.lattice, definition_.volume_stiffness);
  pin_origins_.resize(definition_.pins.size());
  for (std::size_t a = 0; a < definition_.pins.size(); ++a)
    around_.pins.push_back(make_pin(definition_, definition_.pins[a], pin_origins_[a]));
  around_.planes.resize(definition_.planes);
  for (Points* points : {&settings.force, &settings.force_rate, &settings.force_bend[0], &settings.force_bend[1], &around_.force,
                         &around_.force_rate, &around_.force_bend[0], &around_.force_bend[1]})
    points->setZero(n, 3);
  settings.planes.resize(definition_.planes);
  settings.pins.resize(definition_.pins.size());
  for (std::size_t a = 0; a < pin_origins_.size(); ++a) settings.pins[a].position = pin_origins_[a];
  now_.exchange.planes.resize(definition_.planes);
  now_.exchange.pins.resize(definition_.pins.size());
  now_.contacts.resize(definition_.planes);
  for (Points* points : {&now_.motion.x, &now_.motion.v, &now_.motion.spring, &now_.motion.previous, &now_.course.bound_x,
                         &now_.course.factored.x, &now_.outside, &begin_})
    points->setZero(n, 3);
  backup_ = now_;
}

void SoftBody::refresh_body() {
  const int n = definition_.lattice.points();
  material_ = settings;
  const Eigen::Map<const Scalars> shares(definition_.mass.data(), n);
  body_.mass = shares * (settings.mass / shares.sum());
  body_.damping = Scalars::Constant(n, settings.damping);
  for (const Region& region : definition_.regions)
    if (region.damping)
      for (int p : region.points) body_.damping[p] = *region.damping;
  body_.damped = (body_.damping > 0).any();
  body_.springs.set_stiffness(settings.stiffness, overrides_);
  noise_ = 0;
  for (const Springs::Row& row : body_.springs.rows()) noise_ += 0.5 * row.stiffness.sum() * power(slight * body_.length, 2);
  body_.inverse_mass.resize(3 * n);
  body_.damping_rate.resize(3 * n);
  for (int i = 0; i < 3 * n; ++i) {
    const int p = i % n;
    body_.inverse_mass[i] = body_.pinned[p] ? 0 : 1 / body_.mass[p];
    body_.damping_rate[i] = body_.pinned[p] ? 0 : body_.damping[p] / body_.mass[p];
  }
  propagator_.body_changed(body_, now_.course);
  now_.motion.previous_h = 0;
}

StepStatus SoftBody::refresh_surroundings() {
  const double time = now_.motion.time;
  for (std::size_t q = 0; q < around_.planes.size(); ++q) {
    const Settings::PlaneInput& input = settings.planes[q];
    const double size = input.normal.stableNorm();
    if (!(size > 0)) return StepStatus::zero_normal;
    around_.planes[q] = {.point = input.point,
                         .normal = input.normal / size,
                         .velocity = input.velocity,
                         .angular_velocity = input.angular_velocity,
                         .acceleration = input.acceleration,
                         .angular_acceleration = input.angular_acceleration,
                         .normal_rate = input.normal_rate / size,
                         .friction = input.friction,
                         .since = input.moved_by_input ? time : start_time_};
  }
  for (std::size_t a = 0; a < around_.pins.size(); ++a) {
    const Settings::PinInput& input = settings.pins[a];
    const Eigen::Map<const Eigen::Vector4d> q(input.orientation.data());
    const double size = q.stableNorm();
    if (!(size > 0)) return StepStatus::zero_orientation;
    Pin& pin = around_.pins[a];
    pin.position = input.position;
    for (int i = 0; i < 4; ++i) pin.orientation[i] = q[i] / size;
    for (int i = 0; i < 4; ++i) pin.orientation_rate[i] = input.orientation_rate[i] / size;
    pin.velocity = input.velocity;
    pin.angular_velocity = input.angular_velocity;
    pin.acceleration = input.acceleration;
    pin.angular_acceleration = input.angular_acceleration;
    pin.since = time;
  }
  for (int axis = 0; axis < 3; ++axis) around_.force.col(axis) = settings.force.col(axis) + settings.gravity[axis] * body_.mass;
  around_.force_rate = settings.force_rate;
  around_.force_bend = settings.force_bend;
  around_.bent = !settings.force_bend[0].isZero(0) || !settings.force_bend[1].isZero(0);
  around_.ramped = around_.bent || !settings.force_rate.isZero(0);
  around_.since = time;
  return StepStatus::ok;
}

StepStatus SoftBody::clear_jumps(bool& moved) {
  if (around_.planes.empty() || settings.method == Method::central_difference) return StepStatus::ok;
  return jumps_.clear_jumps(body_, around_, now_.motion.time, now_.motion.x, moved);
}

bool SoftBody::place_pins(bool book) {
  bool moved = false;
  State& motion = now_.motion;
  for (std::size_t a = 0; a < around_.pins.size(); ++a) {
    const Pin& pin = around_.pins[a];
    const Frame frame = pin.at(motion.time);
    for (std::size_t n = 0; n < pin.points.size(); ++n) {
      const int p = pin.points[n];
      const Vec3 arm = frame.arm(pin.local[n]), x = frame.origin + arm, v = frame.material_velocity(arm);
      if (book) {
        const Vec3 impulse = body_.mass[p] * (v - row(motion.v, p));
        now_.exchange.pins[a].add(-impulse, arm);
        now_.exchange.work += impulse.dot(0.5 * (v + row(motion.v, p)));
      }
      moved = moved || x != row(motion.x, p);
      set_row(motion.x, p, x);
      set_row(motion.v, p, v);
    }
  }
  return moved;
}

StepStatus SoftBody::initialize(double t0) {
  const Lattice& lattice = definition_.lattice;
  refresh_body();
  stale_ = false;
  State& motion = now_.motion;
  start_time_ = motion.time = t0;
  const StepStatus status = refresh_surroundings();
  if (status != StepStatus::ok) return status;
  motion.x = start_positions(definition_);
  const Vec3 centre = lattice.origin + definition_.stretch.cwiseProduct(0.5 * lattice.size) + definition_.offset;
  for (int p = 0; p < body_.points(); ++p)
    set_row(motion.v, p, definition_.velocity + definition_.angular_velocity.cross(row(motion.x, p) - centre));
  motion.previous_h = 0;
  Points bound_x = std::move(now_.course.bound_x), factored_x = std::move(now_.course.factored.x);
  now_.course = {};
  now_.course.clock.origin = t0;
  now_.course.bound_x = std::move(bound_x);
  now_.course.factored.x = std::move(factored_x);
  for (auto* impulses : {&now_.exchange.planes, &now_.exchange.pins}) std::fill(impulses->begin(), impulses->end(), Impulse{});
  now_.exchange.dissipated = now_.exchange.work = 0;
  now_.exchange_time = 1;
  now_.dissipated = now_.work = 0;
  now_.watch = {};
  now_.contacts_resolved = now_.exchange.contacts_resolved = 0;
  now_.outside = around_.force;
  bool moved = place_pins(false);
  const StepStatus cleared = clear_jumps(moved);
  if (cleared != StepStatus::ok) return cleared;
  count_contacts();
  body_.internal_force(motion.x, motion.spring);
  if (definition_.watch_energy) now_.potential = potential_energy();
  if (!finite(now_)) return StepStatus::not_finite;
  return settings.step == 0 && undecided() ? StepStatus::undecided : StepStatus::ok;
}

StepStatus SoftBody::advance_from_here(double H, double share) {
  State& motion = now_.motion;
  const bool changed = stale_;
  if (stale_) refresh_body();
  stale_ = false;
  const StepStatus status = refresh_surroundings();
  if (status != StepStatus::ok) return status;
  for (auto* impulses : {&now_.exchange.planes, &now_.exchange.pins}) std::fill(impulses->begin(), impulses->end(), Impulse{});
  now_.exchange.dissipated = now_.exchange.work = 0;
  now_.exchange.contacts_resolved = 0;
  now_.exchange_time = H;
  bool moved = place_pins(true);
  const StepStatus cleared = clear_jumps(moved);
  if (cleared != StepStatus::ok) return cleared;
  if (changed || moved) body_.internal_force(motion.x, motion.spring);
  const bool published = settings.method == Method::central_difference && (!around_.planes.empty() || !around_.pins.empty());
  const bool watched = !published && !(body_.damped && around_.ramped);  // both together would cost too much to book
  if (definition_.watch_energy) now_.work += potential_energy() - now_.potential;
  if (definition_.watch_energy || watched) begin_ = motion.x;
  if (!watched) now_.watch.kinetic_elastic = -1;
  const double jump = (around_.force - now_.outside).abs().maxCoeff();
  if (watched && jump > 0) now_.watch.jolt(body_, motion.spring, now_.outside, around_.force);
  const double booked = watched ? open_watch(changed, moved) : 0;
  const Request request{.method = settings.method,
                        .tolerance = settings.tolerance * body_.length,
                        .step = settings.step,
                        .horizon = settings.horizon,
                        .jolt = jump > jolt_share * around_.force.abs().maxCoeff(),
                        .watch = definition_.watch_energy || (watched && around_.ramped),
                        .share = share * settings.step_share};
  const StepStatus ran = propagator_.advance({body_, around_}, request, H, motion, now_.course, now_.exchange);
  if (ran != StepStatus::ok) return ran;
  around_.force_at(motion.time, now_.outside);
  if (watched) close_watch(booked);
  count_contacts();
  now_.contacts_resolved += now_.exchange.contacts_resolved;
  if (definition_.watch_energy) {
    now_.potential = potential_energy();
    now_.dissipated += now_.exchange.dissipated;
    now_.work += now_.exchange.work + (settings.force * (motion.x - begin_)).sum();
  }
  return finite(now_) ? StepStatus::ok : StepStatus::not_finite;
}

void SoftBody::count_contacts() {
  for (std::size_t q = 0; q < around_.planes.size(); ++q)
    now_.contacts[q] = points_on(around_.planes[q].at(now_.motion.time), body_.length, now_.motion.x);
}

void SoftBody::restore(const Progress& progress, double start_time) {
  refresh_body();
  stale_ = false;
  start_time_ = start_time;
  now_ = progress;
}

double SoftBody::kinetic_energy() const { return 0.5 * (body_.mass * now_.motion.v.square().rowwise().sum()).sum(); }

double SoftBody::gravity_energy() const {
  double energy = 0;
  for (int axis = 0; axis < 3; ++axis) energy -= settings.gravity[axis] * (body_.mass * now_.motion.x.col(axis)).sum();
  return energy;
}

Vibration SoftBody::set_off(double kink, Points& scratch, Points& more) const {
  const bool followed = is_implicit(backup_.course.method);
  const State& start = backup_.motion;
  if (followed) {
    scratch = around_.force - backup_.outside;
  } else {  // what is left over of the forces once they hold the body on its turn
    const RigidMotion rigid = rigid_motion(body_.mass, start.x, start.v);
    scratch = around_.force + start.spring;
    for (int p = 0; p < body_.points(); ++p) {
      const Vec3 arm = row(start.x, p) - rigid.centre;
      set_row(scratch, p, row(scratch, p) - body_.mass[p] * rigid.spin.cross(rigid.spin.cross(arm)));
    }
  }
  return softffd::set_off({body_, around_}, start, now_.motion, followed || around_.bent ? kink : 1, scratch, more);
}

double SoftBody::remaining(double t) const {
  const double rate = 0.5 * (body_.damping / body_.mass).minCoeff();
  double growth = 1 + rate * t / 1024;  // exp without the C library, to the power of 1024
  for (int i = 0; i < 10; ++i) growth *= growth;
  return 1 / growth;
}

}  // namespace softffd
