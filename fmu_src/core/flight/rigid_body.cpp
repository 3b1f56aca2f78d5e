#include "flight/rigid_body.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "body/rigid_motion.hpp"

namespace softffd {

namespace {

using Matrix = Eigen::Matrix3d;

/// Number of columns of the extrapolation; its order is twice this number.
constexpr int columns = 6;
/// Largest length of a piece, times the quickest rate of change [rad]; the error of a piece is then far below rounding.
constexpr double longest_piece = 0.3;
constexpr double most_pieces = 30;

/// Returns the rotation matrix of a unit quaternion w x y z.
Matrix rotation(const Eigen::Vector4d& q) {
  const double w = q[0], x = q[1], y = q[2], z = q[3];
  Matrix r;
  r << 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),  //
      2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),   //
      2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y);
  return r;
}

Matrix turn_of(const Eigen::Matrix<double, 13, 1>& y) {
  const Eigen::Vector4d q = y.segment<4>(6);
  return rotation(q / std::sqrt(q.squaredNorm()));
}

/// Returns the sum over j, k of epsilon_ijk a_jk.
Vec3 axial(const Matrix& a) { return {a(1, 2) - a(2, 1), a(2, 0) - a(0, 2), a(0, 1) - a(1, 0)}; }

}  // namespace

void RigidBody::start(const Equations& equations, double t, const Points& x, const Points& v, const Vec3& inner) {
  const auto& [body, around] = equations;
  const RigidMotion motion = rigid_motion(body.mass, x, v);
  mass_ = motion.mass;
  inverse_inertia_ = motion.inverse_inertia;
  y_ << motion.centre, motion.velocity, 1, 0, 0, 0, motion.angular_momentum + inner;
  inner_ = inner;
  damped_ = body.damped;
  derivatives_ = around.bent ? 3 : around.ramped ? 1 : 0;
  t_ = t - around.since;
  radius_ = damping_ = 0;
  const std::array<const Points*, 4> loads{&around.force, &around.force_rate, &around.force_bend[0], &around.force_bend[1]};
  for (int n = 0; n <= derivatives_; ++n) force_[n].setZero(), moments_[n].setZero();
  damped_arm_.setZero();
  damped_inertia_.setZero();
  for (int p = 0; p < body.points(); ++p) {
    const Vec3 arm = row(x, p) - motion.centre;
    radius_ = std::max(radius_, arm.squaredNorm());
    for (int n = 0; n <= derivatives_; ++n) {
      force_[n] += row(*loads[n], p);
      moments_[n] += arm * row(*loads[n], p).transpose();
    }
    if (!damped_) continue;
    damping_ += body.damping[p];
    damped_arm_ += body.damping[p] * arm;
    damped_inertia_ += body.damping[p] * (arm.squaredNorm() * Matrix::Identity() - arm * arm.transpose());
  }
  radius_ = std::sqrt(radius_);
}

RigidBody::Rates RigidBody::rates(double t, const Values& y, const Matrix& turn) const {
  const Vec3 velocity = y.segment<3>(3), momentum = y.tail<3>();
  Rates r;
  r.spin = turn * (inverse_inertia_ * (turn.transpose() * momentum - inner_));
  Vec3 force = force_[derivatives_];
  Matrix moments = moments_[derivatives_];
  for (int n = derivatives_; n > 0; --n) {  // Taylor's sum from its last term
    force = force_[n - 1] + (t / n) * force;
    moments = moments_[n - 1] + (t / n) * moments;
  }
  r.torque = axial(turn * moments);
  if (damped_) {
    const Vec3 arm = turn * damped_arm_;
    force -= damping_ * velocity + r.spin.cross(arm);
    r.torque -= arm.cross(velocity) + turn * (damped_inertia_ * (turn.transpose() * r.spin));
  }
  r.acceleration = force / mass_;
  return r;
}

void RigidBody::slope(double t, const Values& y, Values& f) const {
  const Rates r = rates(t, y, turn_of(y));
  const double w = y[6];
  const Vec3 u = y.segment<3>(7);
  f.head<3>() = y.segment<3>(3);
  f.segment<3>(3) = r.acceleration;
  f[6] = -0.5 * r.spin.dot(u);
  f.segment<3>(7) = 0.5 * (w * r.spin + r.spin.cross(u));
  f.tail<3>() = r.torque;
}

/// Returns the rate at which the motion changes its direction [1/s], by turning, swinging under the forces and damping.
double RigidBody::quickest() const {
  const Rates r = rates(t_, y_, turn_of(y_));
  double moments = 0;
  for (int n = derivatives_; n >= 0; --n) moments = moments_[n].norm() + std::abs(t_) / (n + 1) * moments;
  return r.spin.norm() + std::sqrt(moments * inverse_inertia_.norm()) + damping_ / mass_ + damped_inertia_.norm() * inverse_inertia_.norm();
}

double RigidBody::longest_step() const { return 0.9 * most_pieces * longest_piece / quickest(); }

double RigidBody::advance(double h) {
  const double pieces = std::ceil(quickest() * h / longest_piece);
  if (!(pieces <= most_pieces)) return std::numeric_limits<double>::infinity();
  double error = 0;
  const int count = std::max(1, int(pieces));
  for (int i = 0; i < count; ++i) error += piece(h / count);
  return error;
}

/// Advances by a piece of h [s]. Extrapolates the change, so that only the rounding of the change is multiplied, not that of the values.
double RigidBody::piece(double h) {
  Values first, f, before, here, table[columns];
  slope(t_, y_, first);
  for (int k = 0; k < columns; ++k) {
    const int parts = 2 * (k + 1);
    const double s = h / parts;
    before.setZero();
    here = s * first;
    for (int i = 1; i < parts; ++i) {
      slope(t_ + i * s, y_ + here, f);
      const Values next = before + (2 * s) * f;
      before = here;
      here = next;
    }
    // Neville's scheme in h^2; table[j] holds column j of the row before
    for (int j = 0; j < k; ++j) {
      const Values last = table[j];
      table[j] = here;
      const double ratio = double(parts) / (2 * (k - j));
      here += (here - last) / (ratio * ratio - 1);
    }
    table[k] = here;
  }
  const Values change = table[columns - 1] - table[columns - 2];
  const double error = change.head<3>().norm() + 2 * radius_ * change.segment<4>(6).norm() +
                       h * (change.segment<3>(3).norm() + radius_ * inverse_inertia_.norm() * change.tail<3>().norm());
  y_ += table[columns - 1];
  y_.segment<4>(6) /= std::sqrt(y_.segment<4>(6).squaredNorm());
  t_ += h;
  return error;
}

RigidState RigidBody::state() const {
  RigidState s;
  s.turn = turn_of(y_);
  const Rates r = rates(t_, y_, s.turn);
  s.centre = y_.head<3>();
  s.velocity = y_.segment<3>(3);
  s.acceleration = r.acceleration;
  s.spin = r.spin;
  s.angular_momentum = y_.tail<3>();
  // I w' = L' - w x L, where a part of L is fixed to the body
  s.spin_rate = s.turn * (inverse_inertia_ * (s.turn.transpose() * (r.torque - s.spin.cross(s.angular_momentum))));
  return s;
}

}  // namespace softffd
