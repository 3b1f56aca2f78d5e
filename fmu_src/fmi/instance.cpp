#include "instance.hpp"

#include <cmath>
#include <limits>

namespace softffd::fmi {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Method method_of(double value) {
  switch (MethodValue(int(value))) {
    case MethodValue::automatic: return Method::automatic;
    case MethodValue::central_difference: return Method::central_difference;
    case MethodValue::leapfrog: return Method::leapfrog;
    case MethodValue::bm4: return Method::bm4;
    case MethodValue::rkn12: return Method::rkn12;
    case MethodValue::dop853: return Method::dop853;
    case MethodValue::ros34pw2: return Method::ros34pw2;
  }
  return Method::automatic;
}

}  // namespace

Instance::Instance(SceneFile scene, Logger log) : logger(std::move(log)), scene_(std::move(scene)), body_(scene_.definition) {
  for (std::size_t q = 0; q < scene_.planes.size(); ++q) (scene_.planes[q].input ? input_planes_ : fixed_planes_).push_back(int(q));
  for (std::size_t a = 0; a < scene_.pins.size(); ++a)
    if (scene_.pins[a].input) input_pins_.push_back(int(a));
  for (const auto& probe : scene_.probes) probes_.push_back(embed(scene_.basis, body_.lattice(), probe.at));
  if (scene_.error_estimate) error_estimate_.emplace(scene_.definition);
  count_variables();
  reset();
}

void Instance::reset() {
  phase = instantiated;
  start_time_ = time_ = 0;
  stop_time_ = infinity;
  logged_method_ = -1;
  warned_of_rubbing_ = warned_of_gain_ = warned_of_division_ = warned_of_turning_ = false;
  logged_step_ = -1;
  logged_share_ = 1;
  warned_of_folding_ = false;
  load_starts();
  changed_ = material_changed_ = true;
}

void Instance::start(Family family, std::initializer_list<double> numbers) { values(family).insert(values(family).end(), numbers); }

void Instance::load_starts() {
  for (auto& list : values_) list.clear();
  values(Family::force).assign(3 * scene_.forces.size(), 0.0);
  values(Family::load).assign(3 * scene_.loads.size(), 0.0);
  for (const auto& plane : scene_.planes) {
    const auto add = [&](Family input, Family fixed, const Vec3& v) { start(plane.input ? input : fixed, {v[0], v[1], v[2]}); };
    add(Family::plane_point, Family::fixed_plane_point, plane.point);
    add(Family::plane_normal, Family::fixed_plane_normal, plane.normal);
    add(Family::plane_velocity, Family::fixed_plane_velocity, plane.velocity);
    add(Family::plane_angular_velocity, Family::fixed_plane_angular_velocity, plane.angular_velocity);
    start(Family::plane_friction, {plane.friction});
  }
  for (int a : input_pins_) {
    const Vec3 origin = body_.pin_origin(a);
    start(Family::pin_position, {origin[0], origin[1], origin[2]});
    start(Family::pin_orientation, {1, 0, 0, 0});
    start(Family::pin_velocity, {0, 0, 0});
    start(Family::pin_angular_velocity, {0, 0, 0});
  }
  double mass = 0;
  for (double m : scene_.definition.mass) mass += m;
  start(Family::mass, {mass});
  start(Family::stiffness_edge, {scene_.stiffness.edge});
  start(Family::stiffness_face, {scene_.stiffness.face});
  start(Family::stiffness_body, {scene_.stiffness.body});
  if (scene_.damping) start(Family::damping, {*scene_.damping});
  if (scene_.gravity) start(Family::gravity, {(*scene_.gravity)[0], (*scene_.gravity)[1], (*scene_.gravity)[2]});
  start(Family::solver_method, {double(scene_.method)});
  start(Family::solver_tolerance, {scene_.tolerance});
  start(Family::solver_step, {scene_.step});
  for (int order = 1; order <= highest_order; ++order)
    for (std::size_t family = 0; family < values_.size(); ++family)
      rates_[order - 1][family].assign(order <= highest_order_of(Family(family)) ? values_[family].size() : 0, 0.0);
  rated_ = false;
}

void Instance::setup_experiment(double start_time, double tolerance, double stop_time) {
  start_time_ = time_ = start_time;
  stop_time_ = stop_time;
  if (tolerance > 0) values(Family::solver_tolerance)[0] = tolerance;
  changed_ = true;
}

void Instance::enter_initialization() {
  phase = initializing;
  changed_ = material_changed_ = true;
}

void Instance::exit_initialization() {
  ensure_initial_state();
  phase = stepping;
  warn_of_folding();
  warn_of_start();
}

void Instance::apply_values() {
  Settings& s = body_.settings;
  if (material_changed_) {
    s.mass = values(Family::mass)[0];
    s.stiffness = {values(Family::stiffness_edge)[0], values(Family::stiffness_face)[0], values(Family::stiffness_body)[0]};
    if (scene_.damping) s.damping = values(Family::damping)[0];
    body_.settings_changed();
  }
  if (scene_.gravity) s.gravity = value3(Family::gravity, 0);
  s.method = method_of(values(Family::solver_method)[0]);
  s.tolerance = values(Family::solver_tolerance)[0];
  s.step = values(Family::solver_step)[0];
  s.horizon = std::isfinite(stop_time_) && stop_time_ > start_time_ ? stop_time_ - start_time_ : 1.0;
  s.force.setZero();
  for (Points* rate : {&s.force_rate, &s.force_bend[0], &s.force_bend[1]}) rate->setZero();
  for (std::size_t f = 0; f < scene_.forces.size(); ++f) s.force.row(scene_.forces[f]) += value3(Family::force, int(f)).array().transpose();
  for (std::size_t l = 0; l < scene_.loads.size(); ++l)
    for (int p : scene_.loads[l].points)
      s.force.row(p) += value3(Family::load, int(l)).array().transpose() / double(scene_.loads[l].points.size());
  for (std::size_t n = 0; n < input_planes_.size(); ++n) {
    const int i = int(n);
    s.planes[input_planes_[n]] = {value3(Family::plane_point, i),
                                  value3(Family::plane_normal, i),
                                  value3(Family::plane_velocity, i),
                                  value3(Family::plane_angular_velocity, i),
                                  0,
                                  true};
  }
  for (std::size_t n = 0; n < fixed_planes_.size(); ++n) {
    const int i = int(n);
    s.planes[fixed_planes_[n]] = {value3(Family::fixed_plane_point, i),
                                  value3(Family::fixed_plane_normal, i),
                                  value3(Family::fixed_plane_velocity, i),
                                  value3(Family::fixed_plane_angular_velocity, i),
                                  0,
                                  false};
  }
  for (std::size_t q = 0; q < scene_.planes.size(); ++q) s.planes[q].friction = values(Family::plane_friction)[q];
  for (std::size_t n = 0; n < input_pins_.size(); ++n) {
    const int i = int(n);
    const double* q = values(Family::pin_orientation).data() + 4 * n;
    s.pins[input_pins_[n]] = {value3(Family::pin_position, i),
                              {q[0], q[1], q[2], q[3]},
                              value3(Family::pin_velocity, i),
                              value3(Family::pin_angular_velocity, i)};
  }
  if (rated_) apply_rates();
  changed_ = material_changed_ = false;
}

void Instance::apply_rates() {
  Settings& s = body_.settings;
  const auto given = [](const Vec3& rate) { return !rate.isZero(0); };
  apply_force_rates(1, s.force_rate);
  apply_force_rates(2, s.force_bend[0]);
  apply_force_rates(3, s.force_bend[1]);
  for (std::size_t n = 0; n < input_planes_.size(); ++n) {
    const int i = int(n);
    Settings::PlaneInput& plane = s.planes[input_planes_[n]];
    plane.acceleration = rate3(Family::plane_velocity, i);
    plane.angular_acceleration = rate3(Family::plane_angular_velocity, i);
    plane.normal_rate = rate3(Family::plane_normal, i);
    if (const Vec3 rate = rate3(Family::plane_point, i); given(rate)) plane.velocity = rate, plane.acceleration.setZero();
  }
  for (std::size_t n = 0; n < input_pins_.size(); ++n) {
    const int i = int(n);
    Settings::PinInput& pin = s.pins[input_pins_[n]];
    pin.acceleration = rate3(Family::pin_velocity, i);
    pin.angular_acceleration = rate3(Family::pin_angular_velocity, i);
    const double* rate = rates_[0][std::size_t(Family::pin_orientation)].data() + 4 * n;
    pin.orientation_rate = {rate[0], rate[1], rate[2], rate[3]};
    if (const Vec3 way = rate3(Family::pin_position, i); given(way)) pin.velocity = way, pin.acceleration.setZero();
  }
}

void Instance::apply_force_rates(int order, Points& rate) {
  for (std::size_t f = 0; f < scene_.forces.size(); ++f)
    rate.row(scene_.forces[f]) += rate3(Family::force, int(f), order).array().transpose();
  for (std::size_t l = 0; l < scene_.loads.size(); ++l)
    for (int p : scene_.loads[l].points)
      rate.row(p) += rate3(Family::load, int(l), order).array().transpose() / double(scene_.loads[l].points.size());
}

void Instance::forget_rates() {
  if (!rated_) return;
  for (auto& order : rates_)
    for (auto& list : order) std::fill(list.begin(), list.end(), 0.0);
  rated_ = false;
  changed_ = true;
}

void Instance::ensure_initial_state() {
  if (phase != initializing || !changed_) return;
  apply_values();
  const StepStatus status = body_.initialize(0);  // its clock runs from the start: far from 0 times are coarse
  if (status != StepStatus::ok) {
    changed_ = material_changed_ = true;
    throw CallError("the initial state: " + describe(status, start_time_, 0));
  }
  if (error_estimate_) error_estimate_->initialize(body_, 0);
}

fmi2Status Instance::do_step(double time, double step) {
  const double rounding = 16 * std::numeric_limits<double>::epsilon() * std::max(std::abs(time_), std::abs(start_time_));
  const double slack = rounding + std::min(1e-9 * std::max(1.0, time_ - start_time_), 0.01 * std::abs(step));
  if (!std::isfinite(time) || !(std::abs(time - time_) <= slack))
    throw CallError("fmi2DoStep: currentCommunicationPoint: wanted " + number(time_) + " s, got " + number(time) + ", " +
                    number(time - time_) + " s off");
  if (!std::isfinite(step) || !(step > 0)) throw CallError("fmi2DoStep: communicationStepSize: wanted > 0 s, got " + number(step));
  if (time_ + step > stop_time_ + rounding + 1e-9 * std::max(1.0, stop_time_ - start_time_))
    throw CallError("fmi2DoStep: a step to " + number(time_ + step) + " s goes past the stop time " + number(stop_time_) + " s");
  if (changed_) apply_values();
  const StepStatus status = body_.advance(step);
  if (status == StepStatus::too_many_steps || status == StepStatus::not_finite) {
    phase = step_failed;
    logger.log(fmi2Discard, log_warning, describe(status, time_, step));
    return fmi2Discard;
  }
  if (status != StepStatus::ok) throw CallError("fmi2DoStep: " + describe(status, time_, step));
  if (error_estimate_) error_estimate_->follow(body_, step);
  time_ = time + step;
  forget_rates();
  log_solver_choice();
  warn_of_folding();
  warn_of_gain();
  warn_of_division();
  warn_of_turning();
  return fmi2OK;
}

double Instance::output(Family family, int index) {
  const int instance = index / 3, axis = index % 3;
  const State& state = body_.state();
  switch (family) {
    case Family::position: return state.x(scene_.positions[instance], axis);
    case Family::velocity: return state.v(scene_.velocities[instance], axis);
    case Family::probe: return probes_[instance](state.x.col(axis));
    case Family::plane_reaction: return body_.plane_reaction(instance)[axis];
    case Family::plane_torque: return body_.plane_torque(instance)[axis];
    case Family::plane_contacts: return body_.plane_contacts(index);
    case Family::pin_reaction: return body_.pin_reaction(instance)[axis];
    case Family::pin_torque: return body_.pin_torque(instance)[axis];
    case Family::energy_kinetic: return body_.kinetic_energy();
    case Family::energy_elastic: return body_.elastic_energy();
    case Family::energy_gravity: return body_.gravity_energy();
    case Family::energy_dissipated: return body_.dissipated_energy();
    case Family::energy_work: return body_.work();
    case Family::solver_steps: return double(body_.steps());
    case Family::solver_error_estimate: return error_estimate_->value();
    case Family::solver_rejected: return double(body_.rejected());
    case Family::solver_contacts_resolved: return double(body_.contacts_resolved());
    case Family::solver_stable_step: return body_.stable_step();
    case Family::solver_folded_cells: return body_.folded_cells();
    case Family::force:
    case Family::load:
    case Family::plane_point:
    case Family::plane_normal:
    case Family::plane_velocity:
    case Family::plane_angular_velocity:
    case Family::pin_position:
    case Family::pin_orientation:
    case Family::pin_velocity:
    case Family::pin_angular_velocity:
    case Family::fixed_plane_point:
    case Family::fixed_plane_normal:
    case Family::fixed_plane_velocity:
    case Family::fixed_plane_angular_velocity:
    case Family::plane_friction:
    case Family::mass:
    case Family::stiffness_edge:
    case Family::stiffness_face:
    case Family::stiffness_body:
    case Family::damping:
    case Family::gravity:
    case Family::solver_method:
    case Family::solver_tolerance:
    case Family::solver_step: return values(family)[index];
  }
  return 0;
}

}  // namespace softffd::fmi
