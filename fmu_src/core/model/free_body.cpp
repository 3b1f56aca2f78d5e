#include "model/free_body.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace softffd {

namespace {

/// Largest turn in one part of a flight [rad], and largest number of parts.
constexpr double longest_turn = 0.02;
constexpr double most_parts = 10000;
/// Largest number of iterations for the orientation at the end of an implicit step.
constexpr int turn_rounds = 8;

using Quaternion = Eigen::Vector4d;

Quaternion rate_of(const Quaternion& q, const Vec3& spin) {
  const Vec3 u = q.tail<3>();
  Quaternion rate;
  rate << -0.5 * spin.dot(u), 0.5 * (q[0] * spin + spin.cross(u));
  return rate;
}

std::array<double, 4> unit(const Quaternion& q) {
  const double size = std::sqrt(q.squaredNorm());
  return {q[0] / size, q[1] / size, q[2] / size, q[3] / size};
}

}  // namespace

std::array<double, 4> turned(const std::array<double, 4>& orientation, const std::array<double, 4>& by) {
  const Vec3 a(by[1], by[2], by[3]), b(orientation[1], orientation[2], orientation[3]);
  Quaternion product;
  product << by[0] * orientation[0] - a.dot(b), by[0] * b + orientation[0] * a + a.cross(b);
  return unit(product);
}

std::array<double, 4> turned(const std::array<double, 4>& orientation, const Vec3& by) { return turned(orientation, quaternion(by)); }

FreeState difference(const FreeState& from, const FreeState& to) {
  const auto& [w, x, y, z] = from.orientation;
  return {to.time - from.time, to.position - from.position, turned({w, -x, -y, -z}, to.orientation), to.velocity - from.velocity,
          to.momentum - from.momentum};
}

FreeState beside(const FreeState& from, const FreeState& difference) {
  return {from.time + difference.time, from.position + difference.position, turned(from.orientation, difference.orientation),
          from.velocity + difference.velocity, from.momentum + difference.momentum};
}

Eigen::Matrix3d axes_of(const std::array<double, 4>& orientation) {
  Eigen::Matrix3d axes;
  for (int axis = 0; axis < 3; ++axis) axes.col(axis) = rotated(orientation, Vec3::Unit(axis));
  return axes;
}

FreeMotion::FreeMotion(const FreeBody& body, const std::vector<FreeState>& states, int index)
    : body_(body), states_(&states), index_(index) {
  load({.mass = body.mass}, 0);
}

void FreeMotion::load(const FreeLoad& load, double since, const std::vector<Vec3>& arms, const std::vector<double>& masses) {
  load_ = load;
  since_ = since;
  mass_ = own_mass_ = load.mass;
  own_inertia_ = (load.mass / body_.mass) * body_.inertia;
  inertia_ = own_inertia_.asDiagonal();
  centre_.setZero();
  for (std::size_t n = 0; n < arms.size(); ++n) {
    mass_ += masses[n];
    centre_ += masses[n] * arms[n];
    inertia_ += masses[n] * (arms[n].squaredNorm() * Eigen::Matrix3d::Identity() - arms[n] * arms[n].transpose());
  }
  centre_ /= mass_;
  inertia_ -= mass_ * (centre_.squaredNorm() * Eigen::Matrix3d::Identity() - centre_ * centre_.transpose());
  inverse_inertia_ = inertia_.inverse();
}

FreeState FreeMotion::own(const FreeState& s) const {
  FreeState own = s;
  const Vec3 arm = -rotated(s.orientation, centre_);
  own.position += arm;
  own.velocity += spin(s).cross(arm);
  return own;
}

FreeState FreeMotion::whole(const FreeState& own, const Vec3& spin) const {
  FreeState s = own;
  const Vec3 arm = rotated(own.orientation, centre_);
  s.position += arm;
  if (body_.guided())
    s.velocity = body_.guide.dot(own.velocity) * body_.guide;
  else
    s.velocity += spin.cross(arm);
  s.momentum = momentum(s, spin);
  return s;
}

Wrench FreeMotion::loads(const FreeState& s) const {
  const double age = s.time - since_;
  const Vec3 force = load_.force + age * load_.force_rate;
  return {force, load_.torque + age * load_.torque_rate - rotated(s.orientation, centre_).cross(force)};
}

Wrench FreeMotion::mean_loads(const FreeState& from, double h) const {
  FreeState middle = from;
  middle.time += 0.5 * h;
  return loads(middle);
}

Eigen::Matrix3d FreeMotion::inverse_mass() const {
  if (body_.guided()) return body_.guide * body_.guide.transpose() / mass_;
  return Eigen::Matrix3d::Identity() / mass_;
}

Eigen::Matrix3d FreeMotion::inertia(const FreeState& s) const {
  const Eigen::Matrix3d axes = axes_of(s.orientation);
  return axes * inertia_ * axes.transpose();
}

Eigen::Matrix3d FreeMotion::inverse_inertia(const FreeState& s) const {
  if (body_.guided()) return Eigen::Matrix3d::Zero();
  const Eigen::Matrix3d axes = axes_of(s.orientation);
  return axes * inverse_inertia_ * axes.transpose();
}

Vec3 FreeMotion::spin(const FreeState& s) const {
  if (body_.guided() || s.momentum.isZero(0)) return Vec3::Zero();
  return inverse_inertia(s) * s.momentum;
}

Vec3 FreeMotion::momentum(const FreeState& s, const Vec3& spin) const {
  if (body_.guided()) return Vec3::Zero();
  return inertia(s) * spin;
}

double FreeMotion::kinetic_energy(const FreeState& s) const {
  const FreeState here = own(s);
  const Eigen::Matrix3d axes = axes_of(s.orientation);
  const Vec3 turns = axes.transpose() * spin(s);
  return 0.5 * own_mass_ * here.velocity.squaredNorm() + 0.5 * turns.dot(own_inertia_.cwiseProduct(turns));
}

void FreeMotion::push(FreeState& s, const Vec3& impulse, const Vec3& torque) const {
  s.velocity += inverse_mass() * impulse;
  if (!body_.guided()) s.momentum += torque;
}

FreeState FreeMotion::moved(const FreeState& from, const FreeState& by, double h) const {
  FreeState to = from;
  to.time = from.time + h;
  to.position += h * by.velocity;
  if (!body_.guided()) to.orientation = turned(from.orientation, h * spin(by));
  return to;
}

/// The spin at the end turns the body over the whole step; an iteration finds the orientation at the end.
FreeState FreeMotion::stepped(const FreeState& from, double h, const Vec3& impulse, const Vec3& torque) const {
  FreeState to = from;
  to.time = from.time + h;
  const Wrench load = loads(to);
  push(to, h * load.force + impulse, h * load.torque + torque);
  for (int round = 0; round < turn_rounds; ++round) {
    const FreeState end = moved(from, to, h);
    const bool found = end.orientation == to.orientation;
    to.orientation = end.orientation;
    to.position = end.position;
    if (found) break;
  }
  return to;
}

/// The fourth-order Runge-Kutta method integrates the turn, in parts that turn little.
FreeState FreeMotion::flown(const FreeState& from, double time) const {
  const double h = time - from.time;
  FreeState to = from;
  to.time = time;
  const auto [force, torque] = part() ? Wrench{} : loads(from);
  const FreeLoad rates = part() ? FreeLoad{} : load_;
  const Vec3 acceleration = inverse_mass() * force, jerk = inverse_mass() * rates.force_rate;
  to.position += h * (from.velocity + 0.5 * h * (acceleration + h / 3 * jerk));
  to.velocity += h * (acceleration + 0.5 * h * jerk);
  if (body_.guided() || h == 0) return to;
  const auto momentum = [&](double age) { return Vec3(from.momentum + age * (torque + 0.5 * age * rates.torque_rate)); };
  to.momentum = momentum(h);
  const double angle = std::abs(h) * std::max(spin(from).norm(), spin(to).norm());
  if (angle == 0) return to;
  const double parts = std::clamp(std::ceil(angle / longest_turn), 1.0, most_parts), part = h / parts;
  Quaternion q = Eigen::Map<const Quaternion>(from.orientation.data());
  FreeState here = from;
  const auto slope = [&](double age, const Quaternion& at) {
    here.orientation = unit(at);
    here.momentum = momentum(age);
    return rate_of(at, spin(here));
  };
  for (int i = 0; i < int(parts); ++i) {
    const double age = i * part;
    const Quaternion a = slope(age, q), b = slope(age + 0.5 * part, q + 0.5 * part * a);
    const Quaternion c = slope(age + 0.5 * part, q + 0.5 * part * b), d = slope(age + part, q + part * c);
    q += part / 6 * (a + 2 * b + 2 * c + d);
  }
  to.orientation = unit(q);
  return to;
}

}  // namespace softffd
