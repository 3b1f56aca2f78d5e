#include "soft_body.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "body/rigid_motion.hpp"
#include "contact/stand_ins.hpp"
#include "kit/thresholds.hpp"
#include "model/arithmetic.hpp"
#include "model/lobatto.hpp"
#include "stepping/retry.hpp"

namespace softffd {

namespace {

/// True if any number is not 0. A sum takes several numbers at a time, isZero() takes them one by one.
bool any(const Points& points) { return points.abs().sum() != 0; }

bool finite(const Run& run) {
  return all_finite(run.physical.motion) && all_finite(run.physical.exchange) && all_finite(run.potential) && all_finite(run.energy) &&
         all_finite(run.work) && all_finite(run.dissipated) && all_finite(run.plane_reactions) && all_finite(run.pin_reactions) &&
         all_finite(run.centres) && all_finite(run.sensors) && !std::isnan(run.control.bound);
}

}  // namespace

SoftBody::SoftBody(Definition definition)
    : definition_(std::move(definition)),
      model_(make_body(definition_)),
      regions_(definition_.lattice, definition_.regions),
      cells_(definition_.lattice),
      now_(empty_run(definition_)),
      propagator_(definition_.lattice, definition_.planes, int(definition_.pins.size()),
                  definition_.planes > 0 ? model_.body.samples.get() : nullptr),
      jumps_(definition_.lattice.points(), definition_.planes) {
  const int n = definition_.lattice.points();
  pin_origins_.resize(definition_.pins.size());
  for (std::size_t a = 0; a < definition_.pins.size(); ++a)
    drive_.pins.push_back(make_pin(definition_, definition_.pins[a], pin_origins_[a]));
  drive_.planes.resize(definition_.planes);
  if (definition_.samples && definition_.planes > 0) surface_ = std::make_unique<SurfaceContact>(model_.body, definition_.planes);
  const Sensed& sensed = definition_.sensed;
  if (!sensed.followed.empty()) followed_ = std::make_unique<FollowedPoints>(sensed, definition_.lattice);
  if (followed_ && followed_->every_step()) propagator_.follow(*followed_);
  if (!sensed.patches.empty())
    sensors_ = std::make_unique<Sensors>(sensed, definition_.lattice, surface_ ? definition_.samples.get() : nullptr);
  for (const FreeBody& each : definition_.free) {
    drive_.free.emplace_back(each, now_.physical.motion.free, int(drive_.free.size()));
    settings.free.push_back({.mass = each.mass});
  }
  for (const FreeMotion& each : drive_.free)
    if (each.part())
      drive_.pins[each.body().pin].own = &each;
    else
      drive_.planes[each.body().plane].own = &each;
  for (MarkedPoints* points : {&settings.force, &settings.force_rate, &settings.force_bend[0], &settings.force_bend[1]})
    points->change().setZero(n, 3);
  drive_.force.setZero(n, 3);
  settings.planes.resize(definition_.planes);
  settings.pins.resize(definition_.pins.size());
  for (std::size_t a = 0; a < pin_origins_.size(); ++a) settings.pins[a].position = pin_origins_[a];
}

const Points& SoftBody::shown(const Points& values, Shown& kept) const {
  if (!definition_.solid()) return values;
  if (!kept.known) lobatto::to_control_points(definition_.lattice, values, kept.control_points);
  kept.known = true;
  return kept.control_points;
}

/// Sets up the model for the material of the settings.
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
  Energy& energy = *body.energies.front();
  if (definition_.solid())
    static_cast<Solid&>(energy).set_material(settings.modulus, settings.poissons_ratio, settings.internal_damping);
  else if (definition_.of_modulus)
    regions_.set_modulus(settings.modulus, settings.internal_damping, static_cast<Springs&>(energy));
  else
    regions_.set_stiffness(settings.stiffness, settings.internal_damping, static_cast<Springs&>(energy));
  body.weight = body.mass;
  if (!definition_.weight.empty()) {
    const Eigen::Map<const Scalars> given(definition_.weight.data(), n);
    body.weight = given * (settings.mass / given.sum());
  }
  model_.renew();
}

/// Discards what the run has learnt of the previous material, because it does not hold for the new one.
void SoftBody::take_material() {
  now_.control.forget_material();
  now_.physical.motion.previous_h = 0;
  now_.physical.stiff.begin(Phase::flight);
}

StepStatus SoftBody::refresh_drive() {
  const double time = now_.physical.motion.time;
  for (std::size_t q = 0; q < drive_.planes.size(); ++q) {
    const double size = settings.planes[q].normal.stableNorm();
    if (!(size > 0)) return StepStatus::zero_normal;
    Plane& plane = drive_.planes[q];
    static_cast<PlaneMotion&>(plane) = settings.planes[q];
    plane.normal /= size;
    plane.normal_rate /= size;
    plane.since = plane.moved_by_input ? time : start_time_;
    if (!plane.own && !plane.at(time).normal.allFinite()) return StepStatus::not_finite;  // the rotation overflows
  }
  for (std::size_t a = 0; a < drive_.pins.size(); ++a) {
    const double size = Eigen::Map<const Eigen::Vector4d>(settings.pins[a].orientation.data()).stableNorm();
    if (!(size > 0)) return StepStatus::zero_orientation;
    Pin& pin = drive_.pins[a];
    static_cast<PinMotion&>(pin) = settings.pins[a];
    for (double& component : pin.orientation) component /= size;
    for (double& component : pin.orientation_rate) component /= size;
    pin.since = time;
  }
  refresh_forces();
  refresh_free_bodies();
  drive_.since = time;
  return StepStatus::ok;
}

void SoftBody::refresh_forces() {
  const auto& [bend, more_bend] = settings.force_bend;
  const Loads loads{
      {settings.force.mark(), settings.force_rate.mark(), bend.mark(), more_bend.mark()}, settings.gravity, model_.body.version};
  if (loads == loads_) return;
  loads_ = loads;
  force_mark_ = MarkedPoints::new_mark();
  for (int axis = 0; axis < 3; ++axis) drive_.force.col(axis) = settings.force->col(axis) + settings.gravity[axis] * model_.body.weight;
  drive_.bent = any(*bend) || any(*more_bend);
  drive_.ramped = drive_.bent || any(*settings.force_rate);
  if (drive_.ramped) drive_.force_rate = *settings.force_rate;
  if (drive_.bent) drive_.force_bend = {*bend, *more_bend};
  drive_.even = !drive_.ramped;
  for (int axis = 0; axis < 3; ++axis) drive_.even = drive_.even && all_alike(drive_.force.col(axis));
}

void SoftBody::refresh_free_bodies() {
  for (std::size_t k = 0; k < drive_.free.size(); ++k) {
    FreeLoad load = settings.free[k];
    drive_.free[k].follow(now_.physical.motion.free);  // this object may have been moved
    std::vector<double> masses;
    std::vector<Vec3> arms;
    if (drive_.free[k].part()) {
      const Pin& pin = drive_.pins[definition_.free[k].pin];
      arms = pin.local;
      for (const int p : pin.points) masses.push_back(model_.body.mass[p]);
    }
    FreeState& state = now_.physical.motion.free[k];
    const FreeState own = drive_.free[k].own(state);
    const Vec3 spin = drive_.free[k].spin(state);
    const double before = drive_.free[k].mass();
    load.force += load.mass * settings.gravity;
    drive_.free[k].load(load, state.time, arms, masses);
    if (drive_.free[k].mass() != before) state = drive_.free[k].whole(own, spin);
  }
}

/// Starts each free body: an obstacle where the scene places it, the part of a pin with the object's motion at that place.
void SoftBody::start_free_bodies(const Vec3& centre) {
  for (FreeMotion& each : drive_.free) {
    const FreeBody& body = each.body();
    FreeState own{.time = now_.physical.motion.time};
    Vec3 spin = definition_.angular_velocity;
    if (body.plane >= 0) {
      const PlaneMotion& start = settings.planes[body.plane];
      own.position = start.point;
      own.velocity = start.velocity;
      own.orientation = start.box() ? quaternion(start.rotation) : swing_from_z(start.normal);
      spin = start.angular_velocity;
    } else {
      const PinMotion& start = settings.pins[body.pin];
      own.position = start.position;
      own.orientation = drive_.pins[body.pin].orientation;
      own.velocity = definition_.velocity + spin.cross(own.position - centre);
    }
    now_.physical.motion.free[each.index()] = each.whole(own, spin);
  }
}

StepStatus SoftBody::clear_jumps(bool& moved) {
  if (drive_.planes.empty() || settings.method == Method::central_difference) return StepStatus::ok;
  State& motion = now_.physical.motion;
  if (surface_ && !motion.free.empty())
    if (const StepStatus status = surface_->clear_free_jumps(drive_, motion.time, motion.free, moved); status != StepStatus::ok)
      return status;
  if (surface_) return surface_->clear_jumps(model_.body, drive_, now_.physical.motion.time, now_.physical.motion.x, moved);
  return jumps_.clear_jumps(model_.body, drive_, now_.physical.motion.time, now_.physical.motion.x, moved);
}

bool SoftBody::place_pins(bool book) {
  bool moved = struck_ = false;
  State& motion = now_.physical.motion;
  Exchange& exchange = now_.physical.exchange;
  drive_.visit_pinned(motion.time, [&](const PinnedPoint& held) {
    const int p = held.point;
    const Vec3 x = held.place(), v = held.velocity();
    const Vec3 before = row(motion.v, p);
    if (book) exchange.push(exchange.pins[held.pin], model_.body.mass[p] * (v - before), held.arm, 0.5 * (v + before));
    moved = moved || x != row(motion.x, p);
    struck_ = struck_ || v != before;
    set_row(motion.x, p, x);
    set_row(motion.v, p, v);
  });
  return moved;
}

StepStatus SoftBody::initialize(double t0) {
  forget_shown();
  refresh_model();
  State& motion = now_.physical.motion;
  start_time_ = motion.time = t0;
  const StepStatus status = refresh_drive();
  if (status != StepStatus::ok) return status;
  motion.x = start_positions(definition_, settings.rotation);
  const Vec3 centre = definition_.spin_about_mass ? rigid_motion(model_.body.mass, motion.x, motion.v).centre : start_centre(definition_);
  for (int p = 0; p < model_.body.points(); ++p)
    set_row(motion.v, p, definition_.velocity + definition_.angular_velocity.cross(row(motion.x, p) - centre));
  start_free_bodies(centre);
  motion.previous_h = 0;
  for (Points& forces : motion.holds) forces.setZero();
  motion.held_rows.forget();
  MarkedPoints bound_x = std::move(now_.control.bound_x), factored_x = std::move(now_.control.factored.x);
  MarkedPoints contact_x = std::move(now_.control.in_contact.x);
  Neighbour neighbour = std::move(now_.control.neighbour);
  neighbour.forget();
  neighbour.off = {};
  now_.control = {};
  now_.control.neighbour = std::move(neighbour);
  now_.control.bound_x = std::move(bound_x);
  now_.control.factored.x = std::move(factored_x);
  now_.control.in_contact.x = std::move(contact_x);
  now_.physical.clock = {.origin = t0};
  now_.physical.steps = 0;
  now_.physical.stiff = {};
  now_.physical.error = {};
  now_.physical.damped_error = now_.physical.damped_fading = 0;
  now_.physical.surface.forget();
  now_.physical.exchange.clear();
  now_.hidden = now_.pin_time = 0;
  std::ranges::fill(now_.pin_reactions, Wrench{});
  now_.dissipated = now_.work = 0;
  now_.energy = {};
  now_.contacts_resolved = 0;
  now_.outside.copy(drive_.force, force_mark_);
  bool moved = place_pins(false);
  const StepStatus cleared = clear_jumps(moved);
  if (cleared != StepStatus::ok) return cleared;
  look_at_planes(1);
  if (followed_) followed_->start(now_);
  model_.body.internal_force(motion.x, motion.spring);
  if (definition_.watch_energy) now_.potential = potential_energy();
  now_.free_energy = readings().free_energy();
  if (!finite(now_)) return StepStatus::not_finite;
  return settings.step == 0 && readings().undecided() ? StepStatus::undecided : StepStatus::ok;
}

/// Takes a communication step from the current run. changed: the material differs from that before the step. stand_ins: half-spaces may
/// stand for solids; if one is pressed beside its solid, the step is not taken.
StepStatus SoftBody::advance_from_here(double H, double step_factor, bool changed, bool stand_ins) {
  State& motion = now_.physical.motion;
  Exchange& exchange = now_.physical.exchange;
  if (changed) take_material();
  const StepStatus status = refresh_drive();
  if (status != StepStatus::ok) return status;
  const HiddenForces hidden = hidden_forces({model_.body, drive_}, now_, H);
  if (followed_) followed_->begin(model_, now_);
  for (const Plane& plane : drive_.planes)  // distances are squared
    if (!std::isfinite(plane.pose_at(motion.time + H).point.squaredNorm())) return StepStatus::not_finite;
  exchange.clear(now_.hidden > 0, now_.pin_time > 0);
  bool& moved = moved_ = place_pins(true);
  const StepStatus cleared = clear_jumps(moved);
  if (cleared != StepStatus::ok) return cleared;
  if (changed || moved) model_.body.internal_force(motion.x, motion.spring);
  const bool watched = settings.method != Method::central_difference || (drive_.planes.empty() && drive_.pins.empty());  // as published
  if (definition_.watch_energy) now_.work += potential_energy() - now_.potential;
  if (moved) begin_ = motion.x;
  const Points& begin = moved ? begin_ : before_.physical.motion.x;
  if (!watched) now_.energy.kinetic_elastic = -1;
  const double jump = now_.outside.mark() == force_mark_ ? 0 : (drive_.force - *now_.outside).abs().maxCoeff();
  if (watched && jump > 0) jolt(now_.energy, model_.body, motion.spring, *now_.outside, drive_.force);
  const double booked = watched ? open_account(now_, before_, model_, drive_, changed, moved) : 0;
  if (!all_finite(now_.energy)) return StepStatus::not_finite;  // squares of the forces overflow
  drive_.damping_unwatched = !definition_.watch_energy;         // the energy account does not need the damping
  drive_.watch = definition_.watch_energy || (watched && drive_.ramped);
  const double by_loads = jump > 0 || drive_.ramped ? may_set_off(model_, drive_, *now_.outside, H) : 0;
  const Request request{.method = settings.method,
                        .tolerance = settings.tolerance * model_.body.length,
                        .step = settings.step,
                        .horizon = settings.horizon,
                        .stirs = changed || moved || struck_ || std::ranges::any_of(drive_.pins, &Pin::moves) ? infinity : by_loads,
                        .step_factor = step_factor * settings.step_factor};
  if (definition_.solids && stand_ins && drive_.free.empty()) let_half_spaces_stand(model_.body, drive_, motion, H);
  const StepStatus ran = propagator_.advance({model_, drive_, request, now_}, H);
  if (definition_.solids) meet_solids(drive_);
  if (ran != StepStatus::ok) return ran;
  const double of_means = time_of_means(hidden, before_, before_.physical.motion.time == start_time_, H, now_);
  if (followed_) followed_->end(model_.body, of_means, before_, now_);
  if (drive_.ramped)
    drive_.force_at(motion.time, now_.outside.change());
  else
    now_.outside.copy(drive_.force, force_mark_);
  if (watched) close_account(now_, model_, drive_, begin, booked);
  take_means_of_pins(H, now_);
  look_at_planes(of_means);
  now_.contacts_resolved += exchange.contacts_resolved;
  if (definition_.watch_energy) {
    now_.potential = potential_energy();
    now_.dissipated += exchange.dissipated;
    now_.work += exchange.work + (*settings.force * (motion.x - begin)).sum();
  }
  return finite(now_) ? StepStatus::ok : StepStatus::not_finite;
}

void SoftBody::look_at_planes(double of_means) {
  const State& motion = now_.physical.motion;
  if (surface_) surface_->count(drive_, motion.time, motion.x, now_.contacts);
  for (std::size_t q = 0; q < drive_.planes.size(); ++q) {
    const HalfSpace plane = drive_.planes[q].at(motion.time);
    if (!surface_) now_.contacts[q] = points_on(plane, model_.body.length, motion.x);
    if (of_means == 0) continue;
    const Impulse& on = now_.physical.exchange.planes[q];
    now_.plane_reactions[q] = on.mean(of_means);
    now_.centres[q] = drive_.planes[q].solid() ? centre_of_places(plane, on) : centre_of_pressure(plane, on);
  }
  if (sensors_ && of_means > 0) sensors_->read(drive_, settings.tolerance * model_.body.length, of_means, now_);
}

void SoftBody::restore(const Run& run, double start_time) {
  forget_shown();
  refresh_model();
  refresh_free_bodies();
  start_time_ = start_time;
  now_ = run;
}

StepStatus SoftBody::advance(double H) {
  forget_shown();
  divided_ = 1;
  const bool changed = material_waits();
  const Material in_effect = material_;
  Snapshot snapshot(now_, before_);
  if (changed) refresh_model();
  const bool automatic = settings.step == 0;
  const double usual = automatic ? now_.energy.step_factor : 1;
  bool stand_ins = true;
  const auto attempt = [&](double step_factor) {
    const EnergyAccount begun = now_.energy;
    const StepStatus ran = advance_from_here(H, step_factor, changed, stand_ins);
    if (ran != StepStatus::beside_solid) return ran;
    stand_ins = false;
    snapshot.rollback();
    now_.energy = begun;
    return advance_from_here(H, step_factor, changed, stand_ins);
  };
  Budget& budget = propagator_.budget();
  const double most = settings.most_work * thresholds::patience(model_.body.points());
  budget.begin(most);
  ++drive_.call;
  StepStatus status = attempt(usual);
  came_ = now_.physical.motion.time - before_.physical.motion.time;
  const bool astray = status == StepStatus::too_much_work && now_.control.work > before_.control.work;  // not at the very start
  if (status == StepStatus::not_finite || astray)
    status = retry_divided(now_, snapshot, most, usual, status, divided_, attempt);
  else if (status == StepStatus::ok && automatic && !now_.energy.hopeless && readings().gains_energy())
    status = retry_gained(now_, snapshot, budget, most, account_at_start(before_, model_, drive_, changed), attempt);
  work_done_ = most - budget.left();
  if (status == StepStatus::ok) {
    snapshot.commit();
    return status;
  }
  if (changed) {  // outputs show the previous material again
    const Material wanted = std::exchange(static_cast<Material&>(settings), in_effect);
    refresh_model();
    static_cast<Material&>(settings) = wanted;
  }
  return status;
}

}  // namespace softffd
