#include "soft_body.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "model/rigid_motion.hpp"
#include "stepping/retry.hpp"
#include "stepping/thresholds.hpp"

namespace softffd {

namespace {

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

Body make_body(const Definition& definition) {
  const int n = definition.lattice.points();
  Body body{.springs = Springs(definition.lattice, definition.topology), .mass = {}, .damping = {}, .pinned = pinned_points(definition)};
  body.mass = Eigen::Map<const Scalars>(definition.mass.data(), n);
  body.damping = Scalars::Zero(n);
  body.length = definition.lattice.largest_side();
  if (definition.volume_stiffness > 0) body.volume.emplace(definition.lattice, definition.volume_stiffness);
  return body;
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

Run empty_run(const Definition& definition) {
  const int n = definition.lattice.points();
  Run run;
  run.path.exchange.planes.resize(definition.planes);
  run.path.exchange.pins.resize(definition.pins.size());
  run.contacts.resize(definition.planes);
  State& motion = run.path.motion;
  for (Points* points : {&motion.x, &motion.v, &motion.spring, &motion.previous, &run.course.bound_x, &run.course.factored.x, &run.outside})
    points->setZero(n, 3);
  return run;
}

bool finite(const Run& run) {
  const auto mean_is_finite = [H = run.exchange_time](const Impulse& impulse) {
    return (impulse.force / H).allFinite() && (impulse.torque / H).allFinite();
  };
  const Exchange& exchange = run.path.exchange;
  return all_finite(run.path.motion) && all_finite(exchange) && all_finite(run.potential) && all_finite(run.energy.kinetic_elastic) &&
         all_finite(run.work) && all_finite(run.dissipated) && !std::isnan(run.course.bound) &&
         std::all_of(exchange.planes.begin(), exchange.planes.end(), mean_is_finite) &&
         std::all_of(exchange.pins.begin(), exchange.pins.end(), mean_is_finite);
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
      model_(make_body(definition_)),
      overrides_(stiffness_overrides(definition_)),
      cells_(definition_.lattice),
      now_(empty_run(definition_)),
      before_(now_),
      propagator_(definition_.lattice, now_),
      jumps_(definition_.lattice.points(), definition_.planes) {
  const int n = definition_.lattice.points();
  pin_origins_.resize(definition_.pins.size());
  for (std::size_t a = 0; a < definition_.pins.size(); ++a)
    drive_.pins.push_back(make_pin(definition_, definition_.pins[a], pin_origins_[a]));
  drive_.planes.resize(definition_.planes);
  for (Points* points : {&settings.force, &settings.force_rate, &settings.force_bend[0], &settings.force_bend[1], &drive_.force,
                         &drive_.force_rate, &drive_.force_bend[0], &drive_.force_bend[1], &begin_})
    points->setZero(n, 3);
  settings.planes.resize(definition_.planes);
  settings.pins.resize(definition_.pins.size());
  for (std::size_t a = 0; a < pin_origins_.size(); ++a) settings.pins[a].position = pin_origins_[a];
}

/// The model of the settings' material.
void SoftBody::refresh_model() {
  const int n = definition_.lattice.points();
  Body& body = model_.body;
  material_ = settings;
  const Eigen::Map<const Scalars> weights(definition_.mass.data(), n);
  body.mass = weights * (settings.mass / weights.sum());
  body.damping = Scalars::Constant(n, settings.damping);
  for (const Region& region : definition_.regions)
    if (region.damping)
      for (int p : region.points) body.damping[p] = *region.damping;
  body.springs.set_stiffness(settings.stiffness, overrides_);
  model_.renew();
}

/// What the run knows of the material before does not hold for this one.
void SoftBody::take_material() {
  now_.course.forget_material();
  now_.path.motion.previous_h = 0;
}

StepStatus SoftBody::refresh_drive() {
  const double time = now_.path.motion.time;
  for (std::size_t q = 0; q < drive_.planes.size(); ++q) {
    const Settings::PlaneInput& input = settings.planes[q];
    const double size = input.normal.stableNorm();
    if (!(size > 0)) return StepStatus::zero_normal;
    drive_.planes[q] = {.point = input.point,
                        .normal = input.normal / size,
                        .velocity = input.velocity,
                        .angular_velocity = input.angular_velocity,
                        .acceleration = input.acceleration,
                        .angular_acceleration = input.angular_acceleration,
                        .normal_rate = input.normal_rate / size,
                        .friction = input.friction,
                        .since = input.moved_by_input ? time : start_time_};
  }
  for (std::size_t a = 0; a < drive_.pins.size(); ++a) {
    const Settings::PinInput& input = settings.pins[a];
    const Eigen::Map<const Eigen::Vector4d> q(input.orientation.data());
    const double size = q.stableNorm();
    if (!(size > 0)) return StepStatus::zero_orientation;
    Pin& pin = drive_.pins[a];
    pin.position = input.position;
    for (int i = 0; i < 4; ++i) pin.orientation[i] = q[i] / size;
    for (int i = 0; i < 4; ++i) pin.orientation_rate[i] = input.orientation_rate[i] / size;
    pin.velocity = input.velocity;
    pin.angular_velocity = input.angular_velocity;
    pin.acceleration = input.acceleration;
    pin.angular_acceleration = input.angular_acceleration;
    pin.since = time;
  }
  for (int axis = 0; axis < 3; ++axis) drive_.force.col(axis) = settings.force.col(axis) + settings.gravity[axis] * model_.body.mass;
  drive_.force_rate = settings.force_rate;
  drive_.force_bend = settings.force_bend;
  drive_.bent = !settings.force_bend[0].isZero(0) || !settings.force_bend[1].isZero(0);
  drive_.ramped = drive_.bent || !settings.force_rate.isZero(0);
  drive_.since = time;
  return StepStatus::ok;
}

StepStatus SoftBody::clear_jumps(bool& moved) {
  if (drive_.planes.empty() || settings.method == Method::central_difference) return StepStatus::ok;
  return jumps_.clear_jumps(model_.body, drive_, now_.path.motion.time, now_.path.motion.x, moved);
}

bool SoftBody::place_pins(bool book) {
  bool moved = false;
  State& motion = now_.path.motion;
  for (std::size_t a = 0; a < drive_.pins.size(); ++a) {
    const Pin& pin = drive_.pins[a];
    const Frame frame = pin.at(motion.time);
    for (std::size_t n = 0; n < pin.points.size(); ++n) {
      const int p = pin.points[n];
      const Vec3 arm = frame.arm(pin.local[n]), x = frame.origin + arm, v = frame.material_velocity(arm);
      if (book) {
        const Vec3 impulse = model_.body.mass[p] * (v - row(motion.v, p));
        now_.path.exchange.pins[a].add(-impulse, arm);
        now_.path.exchange.work += impulse.dot(0.5 * (v + row(motion.v, p)));
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
  refresh_model();
  stale_ = false;
  State& motion = now_.path.motion;
  start_time_ = motion.time = t0;
  const StepStatus status = refresh_drive();
  if (status != StepStatus::ok) return status;
  motion.x = start_positions(definition_);
  const Vec3 centre = lattice.origin + definition_.stretch.cwiseProduct(0.5 * lattice.size) + definition_.offset;
  for (int p = 0; p < model_.body.points(); ++p)
    set_row(motion.v, p, definition_.velocity + definition_.angular_velocity.cross(row(motion.x, p) - centre));
  motion.previous_h = 0;
  Points bound_x = std::move(now_.course.bound_x), factored_x = std::move(now_.course.factored.x);
  now_.course = {};
  now_.course.bound_x = std::move(bound_x);
  now_.course.factored.x = std::move(factored_x);
  now_.path.clock = {.origin = t0};
  now_.path.steps = 0;
  now_.path.exchange.clear();
  now_.exchange_time = 1;
  now_.dissipated = now_.work = 0;
  now_.energy = {};
  now_.contacts_resolved = 0;
  now_.outside = drive_.force;
  bool moved = place_pins(false);
  const StepStatus cleared = clear_jumps(moved);
  if (cleared != StepStatus::ok) return cleared;
  count_contacts();
  model_.body.internal_force(motion.x, motion.spring);
  if (definition_.watch_energy) now_.potential = potential_energy();
  if (!finite(now_)) return StepStatus::not_finite;
  return settings.step == 0 && undecided() ? StepStatus::undecided : StepStatus::ok;
}

/// A communication step from the run as it is. changed: the material is another than before it.
StepStatus SoftBody::advance_from_here(double H, double step_factor, bool changed) {
  State& motion = now_.path.motion;
  Exchange& exchange = now_.path.exchange;
  if (changed) take_material();
  const StepStatus status = refresh_drive();
  if (status != StepStatus::ok) return status;
  exchange.clear();
  now_.exchange_time = H;
  bool moved = place_pins(true);
  const StepStatus cleared = clear_jumps(moved);
  if (cleared != StepStatus::ok) return cleared;
  if (changed || moved) model_.body.internal_force(motion.x, motion.spring);
  const bool published = settings.method == Method::central_difference && (!drive_.planes.empty() || !drive_.pins.empty());
  const bool watched = !published && !(model_.body.damped && drive_.ramped);  // both together would cost too much to book
  if (definition_.watch_energy) now_.work += potential_energy() - now_.potential;
  if (definition_.watch_energy || watched) begin_ = motion.x;
  if (!watched) now_.energy.kinetic_elastic = -1;
  const double jump = (drive_.force - now_.outside).abs().maxCoeff();
  if (watched && jump > 0) jolt(now_.energy, model_.body, motion.spring, now_.outside, drive_.force);
  const double booked = watched ? open_account(changed, moved) : 0;
  drive_.watch = definition_.watch_energy || (watched && drive_.ramped);
  const Request request{.method = settings.method,
                        .tolerance = settings.tolerance * model_.body.length,
                        .step = settings.step,
                        .horizon = settings.horizon,
                        .jolt = jump > thresholds::jolt * drive_.force.abs().maxCoeff(),
                        .step_factor = step_factor * settings.step_factor};
  const StepStatus ran = propagator_.advance({model_, drive_, request, now_}, H);
  if (ran != StepStatus::ok) return ran;
  drive_.force_at(motion.time, now_.outside);
  if (watched) close_account(booked);
  count_contacts();
  now_.contacts_resolved += exchange.contacts_resolved;
  if (definition_.watch_energy) {
    now_.potential = potential_energy();
    now_.dissipated += exchange.dissipated;
    now_.work += exchange.work + (settings.force * (motion.x - begin_)).sum();
  }
  return finite(now_) ? StepStatus::ok : StepStatus::not_finite;
}

void SoftBody::count_contacts() {
  for (std::size_t q = 0; q < drive_.planes.size(); ++q)
    now_.contacts[q] = points_on(drive_.planes[q].at(now_.path.motion.time), model_.body.length, now_.path.motion.x);
}

void SoftBody::restore(const Run& run, double start_time) {
  refresh_model();
  stale_ = false;
  start_time_ = start_time;
  now_ = run;
}

double SoftBody::kinetic_energy() const { return 0.5 * (model_.body.mass * now_.path.motion.v.square().rowwise().sum()).sum(); }

double SoftBody::gravity_energy() const {
  double energy = 0;
  for (int axis = 0; axis < 3; ++axis) energy -= settings.gravity[axis] * (model_.body.mass * now_.path.motion.x.col(axis)).sum();
  return energy;
}

Vibration SoftBody::set_off(double kink, Points& scratch, Points& more) const {
  const bool followed = is_implicit(before_.course.method);
  const State& start = before_.path.motion;
  if (followed) {
    scratch = drive_.force - before_.outside;
  } else {  // what is left over of the forces once they hold the body on its turn
    const RigidMotion rigid = rigid_motion(model_.body.mass, start.x, start.v);
    scratch = drive_.force + start.spring;
    for (int p = 0; p < model_.body.points(); ++p) {
      const Vec3 arm = row(start.x, p) - rigid.centre;
      set_row(scratch, p, row(scratch, p) - model_.body.mass[p] * rigid.spin.cross(rigid.spin.cross(arm)));
    }
  }
  return softffd::set_off({model_.body, drive_}, start, now_.path.motion, followed || drive_.bent ? kink : 1, scratch, more);
}

double SoftBody::remaining(double t) const {
  const double rate = 0.5 * (model_.body.damping / model_.body.mass).minCoeff();
  double growth = 1 + rate * t / 1024;  // exp without the C library, to the power of 1024
  for (int i = 0; i < 10; ++i) growth *= growth;
  return 1 / growth;
}

/// Where nothing moves at all, nothing is to be decided.
bool SoftBody::undecided() const {
  const State& motion = now_.path.motion;
  if (motion.spring.isZero(0)) return false;
  for (const Springs::Row& springs : model_.body.springs.rows())
    for (int lane = 0; lane < springs.lanes(); ++lane) {
      const int p = springs.begin + lane, q = p + springs.offset;
      const bool apart = row(motion.x, p) != row(motion.x, q) || row(motion.v, p) != row(motion.v, q);
      if (!apart && springs.stiffness[lane] > 0 && !(model_.body.pinned[p] && model_.body.pinned[q])) return true;
    }
  return false;
}

StepStatus SoftBody::advance(double H) {
  divided_ = 1;
  const bool changed = stale_;
  const Material in_effect = material_;
  Trial trial(now_, before_);
  if (changed) refresh_model();
  stale_ = false;
  const bool automatic = settings.step == 0;
  const double usual = automatic ? now_.energy.step_factor : 1;
  const auto attempt = [&](double step_factor) { return advance_from_here(H, step_factor, changed); };
  StepStatus status = attempt(usual);
  const bool astray = status == StepStatus::too_many_steps && now_.course.work > before_.course.work;  // not from the start
  if (status == StepStatus::not_finite || astray)
    status = retry_divided(now_, trial, usual, status, divided_, attempt);
  else if (status == StepStatus::ok && automatic && !now_.energy.hopeless && gains_energy())
    status = retry_gained(now_, trial, account_at_start(changed), attempt);
  if (status == StepStatus::ok) {
    trial.keep();
    return status;
  }
  if (changed) {  // outputs are again those of the material before
    const Material wanted = std::exchange(static_cast<Material&>(settings), in_effect);
    refresh_model();
    static_cast<Material&>(settings) = wanted;
  }
  stale_ = changed;
  return status;
}

/// The energy account at the start of the communication step, as a look there shows it.
EnergyAccount SoftBody::account_at_start(bool changed) const {
  EnergyAccount account = before_.energy;
  if (changed || account.kinetic_elastic < 0) return account;
  const State& motion = before_.path.motion;
  jolt(account, model_.body, motion.spring, before_.outside, drive_.force);
  look(account, {model_.body, drive_}, motion, staggered_step(before_), 0);
  jolt(account, model_.body, motion.spring, drive_.force, before_.outside);
  return account;
}

/// Books what moved points without the body's own motion. Returns what of the exchange's work is booked already.
double SoftBody::open_account(bool changed, bool moved) {
  EnergyAccount& account = now_.energy;
  const State &motion = now_.path.motion, &before = before_.path.motion;
  const bool far = moved && (motion.x - before.x).abs().maxCoeff() > thresholds::jump * model_.body.length;
  if (account.kinetic_elastic < 0 || changed || far) {
    start(account, {model_.body, drive_}, motion, now_.course.work);
    return now_.path.exchange.work;
  }
  if (moved) account.received -= 0.5 * ((motion.spring + before.spring) * (motion.x - before.x)).sum();
  return 0;
}

/// The same with and without energy outputs: what only they have counted is not read.
void SoftBody::close_account(double booked) {
  EnergyAccount& account = now_.energy;
  if (now_.course.method == Method::backward_euler) {  // has a guard of its own
    account.kinetic_elastic = -1;
    return;
  }
  const Exchange& exchange = now_.path.exchange;
  const double taken = model_.body.damped ? 0 : exchange.dissipated;
  account.received += (drive_.force * (now_.path.motion.x - begin_)).sum() + exchange.work - booked - taken;
  if (now_.course.work >= account.due) look(account, {model_.body, drive_}, now_.path.motion, staggered_step(now_), now_.course.work);
}

double SoftBody::damped_spin() const {
  if (now_.course.method != Method::backward_euler) return 0;
  const auto spin = [&](const State& state) { return rigid_motion(model_.body.mass, state.x, state.v).spin.norm(); };
  return std::max(spin(before_.path.motion), spin(now_.path.motion));
}

double SoftBody::lost_energy() const { return lost(now_.energy, {model_.body, drive_}, now_); }

bool SoftBody::rubs_undamped() {
  if (model_.body.damped || settings.step == 0 || now_.path.exchange.contacts_resolved == 0) return false;
  const auto rubs = [](const Plane& plane) { return plane.friction > 0; };
  return std::any_of(drive_.planes.begin(), drive_.planes.end(), rubs) && internal_step() > thresholds::rubbing * stable_step();
}

}  // namespace softffd
