#include "flight/floating_frame.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "body/rigid_motion.hpp"
#include "flight/attitude.hpp"
#include "methods/traits.hpp"

namespace softffd {

namespace {

using Matrix = Eigen::Matrix3d;

/// Weight of the neglected forces in the error [1]. They turn vibrations out of their direction in the same sense in every step, whereas
/// estimated errors may add up to this multiple of the tolerance (traits.hpp).
const double systematic = traits(Method::floating_frame).tolerance_sum;

}  // namespace

FloatingFrame::FloatingFrame(const Lattice& lattice, Ros34pw2& deformation)
    : OneStep(Method::floating_frame, lattice.points(), 0, deformation.exponent, true),
      deformation_(deformation),
      rest_(rest_positions(lattice)) {
  around_.ramped = true;
  for (Points* points : {&around_.force, &around_.force_rate, &shape_.x, &shape_.v, &shape_.spring, &arm_, &outside_})
    points->setZero(lattice.points(), 3);
}

Outcome FloatingFrame::attempt_in(const Equations& equations, double t, double h, Run& run) {
  growth_ = run.control.tumbling.growth;
  return deformation_.with_factor_of(run, true, [&] { return attempt(equations, t, h, run.physical.motion); });
}

void FloatingFrame::take_material(const Model& model) { time_scale = deformation_.time_scale = model.time_scale; }

double FloatingFrame::attempt(const Equations& equations, double t, double h, const State& state) {
  const Body& body = equations.body;
  body_.start(equations, t, state.x, state.v);
  const RigidState begin = body_.state();
  enter_frame(body, state, begin);
  load_frame(equations, t, begin, around_.force);
  const double rigid_error = body_.advance(h);
  if (!std::isfinite(rigid_error)) return rigid_error;
  const RigidState end = body_.state();
  load_frame(equations, t + h, end, around_.force_rate);
  around_.force_rate = (around_.force_rate - around_.force) / h;
  around_.since = t;
  const Equations in_frame{body, around_};
  deformation_.ledger.open(in_frame, false);
  const double error = deformation_.attempt(in_frame, t, h, shape_);
  const double neglected = leave_frame(equations, t + h, h, end);
  if (ledger.recording()) lose(equations, t, h, state);
  return error + neglected + growth_ * rigid_error;
}

void FloatingFrame::enter_frame(const Body& body, const State& state, const RigidState& rigid) {
  Matrix covariance = Matrix::Zero();
  for (int p = 0; p < body.points(); ++p) {
    set_row(arm_, p, row(state.x, p) - rigid.centre);
    covariance += body.mass[p] * row(arm_, p) * row(rest_, p).transpose();
  }
  attitude_ = rotation_next_to(covariance);
  for (int p = 0; p < body.points(); ++p) {
    const Vec3 arm = row(arm_, p);
    set_row(shape_.x, p, attitude_.transpose() * arm);
    set_row(shape_.v, p, attitude_.transpose() * (row(state.v, p) - rigid.velocity - rigid.spin.cross(arm)));
  }
  body.internal_force(shape_.x, shape_.spring);
}

/// Computes the outside forces less the drag and the inertia of the frame's motion, in the axes of the frame [N].
void FloatingFrame::load_frame(const Equations& equations, double t, const RigidState& rigid, Points& load) {
  const Body& body = equations.body;
  const Points& outside = equations.outside(t, outside_);
  const Matrix axes = rigid.turn * attitude_;
  for (int p = 0; p < body.points(); ++p) {
    const Vec3 arm = rigid.turn * row(arm_, p), turning = rigid.spin.cross(arm);
    Vec3 force = row(outside, p) - body.mass[p] * (rigid.acceleration + rigid.spin_rate.cross(arm) + rigid.spin.cross(turning));
    if (body.damped) force -= body.damping[p] * (rigid.velocity + turning);
    set_row(load, p, axes.transpose() * force);
  }
}

/// Composes the motion: the deformation without its centre's motion, the spin, and a turn by half a step of the spin that the angular
/// momentum adds. Returns how far the neglected forces of the frame on the deformation may move a point in the step, and what the bend of
/// the spin within the step may have become at the end of the run [m].
double FloatingFrame::leave_frame(const Equations& equations, double t, double h, const RigidState& rigid) {
  const Body& body = equations.body;
  const Points& outside = equations.outside(t, outside_);
  const RigidMotion inner = rigid_motion(body.mass, deformation_.x, deformation_.v);
  Matrix axes = rigid.turn * attitude_;
  Vec3 torque = Vec3::Zero();
  for (int p = 0; p < body.points(); ++p)
    torque += (axes * (row(deformation_.x, p) - inner.centre - row(shape_.x, p))).cross(row(outside, p));
  const Vec3 angular_momentum = rigid.angular_momentum + (0.5 * h) * torque;
  const auto spin = [&] { return Vec3(inner.inverse_inertia * (axes.transpose() * angular_momentum) - inner.spin); };
  const Vec3 lag = (0.5 * h) * (spin() - axes.transpose() * rigid.spin);
  double farthest = 0;
  Matrix turn = Matrix::Identity();
  for (int axis = 0; axis < 3; ++axis) turn.col(axis) += lag.cross(Vec3::Unit(axis)) + second_order(lag, Vec3::Unit(axis));
  axes = axes * turn;
  const Vec3 turning = axes * spin();
  double neglected = 0;
  for (int p = 0; p < body.points(); ++p) {
    const Vec3 y = row(deformation_.x, p) - inner.centre, arm = axes * y, drift = axes * (row(deformation_.v, p) - inner.velocity),
               change = axes * (y - row(shape_.x, p));
    farthest = std::max(farthest, y.squaredNorm());
    set_row(x, p, rigid.centre + arm);
    set_row(v, p, rigid.velocity + turning.cross(arm) + drift);
    const Vec3 less = 2 * turning.cross(drift) + rigid.spin_rate.cross(change) + turning.cross(turning.cross(change));
    neglected = std::max(neglected, std::sqrt(less.squaredNorm()) * std::max(0.5 * h, systematic * deformation_.time_scale[p]));
  }
  const double bend = h * std::sqrt(turning.squaredNorm() * lag.squaredNorm() * farthest) / 6;
  return h * neglected + systematic * growth_ * bend;
}

/// Books the work of force ramps, along the cubic through both ends, and the energy that is missing after the step.
void FloatingFrame::lose(const Equations& equations, double t, double h, const State& state) {
  const auto& [body, around] = equations;
  double ramp = 0, constant = 0, gain = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (int p = 0; p < body.points(); ++p) {
      gain += 0.5 * body.mass[p] * (v(p, axis) - state.v(p, axis)) * (v(p, axis) + state.v(p, axis));
      constant += around.force(p, axis) * (x(p, axis) - state.x(p, axis));
    }
  if (around.ramped) {
    outside_ = 0.5 * (state.x + x) + (h / 8) * (state.v - v);
    const double rates =
        around.ramp_rate_dot(t, state.x) + 4 * around.ramp_rate_dot(t + 0.5 * h, outside_) + around.ramp_rate_dot(t + h, x);
    ramp = around.ramp_dot(t + h, x) - around.ramp_dot(t, state.x) - h / 6 * rates;
  }
  const double stored = body.elastic_energy(x) - body.elastic_energy(state.x);
  ledger.book(ramp, constant + ramp - gain - stored);
}

}  // namespace softffd
