#include "methods/ros34pw2.hpp"

#include <cmath>
#include <cstring>

#include "body/rigid_motion.hpp"
#include "model/arithmetic.hpp"

namespace softffd {

namespace {

// Rang, Angermann 2005, New Rosenbrock W-methods of order 3 for partial differential algebraic equations of index 1, BIT 45, transformed as
// in Hairer, Wanner 1996, Solving Ordinary Differential Equations II, section IV.7.
constexpr int stages = Ros34pw2::stages;
using Row = std::array<double, stages>;
constexpr double gamma = 0.435866521508459;
constexpr std::array<Row, stages> a{{{0, 0, 0, 0},
                                     {2, 0, 0, 0},
                                     {1.4192173174557647, -0.2592322116729697, 0, 0},
                                     {4.18476048231916, -0.28519201735549593, 2.294280360279042, 0}}};
constexpr std::array<Row, stages> c{{{0, 0, 0, 0},
                                     {-4.588560720558084, 0, 0, 0},
                                     {-4.18476048231916, 0.28519201735549593, 0, 0},
                                     {-6.368179200128359, -6.795620944466837, 2.8700986043310563, 0}}};
constexpr Row time{0, 0.871733043016918, 0.7315799577888524, 1};
constexpr Row time_gamma{0.435866521508459, -0.435866521508459, -0.4133333762338865, 0};
constexpr Row m{4.1847604823191595, -0.28519201735549565, 2.2942803602790414, 1.0};
constexpr Row e{0.2777499476479681, -1.4032398951759992, 1.7726301276675507, 0.5};  // m minus the weights of the embedded method of order 2

/// Weights b of the stages' slopes f + J U: the solution of b^T (I/gamma - c) = m^T, from the last stage to the first.
constexpr Row slope_weights() {
  Row b{};
  for (int j = stages - 1; j >= 0; --j) {
    double sum = m[j];
    for (int i = j + 1; i < stages; ++i) sum += b[i] * c[i][j];
    b[j] = gamma * sum;
  }
  return b;
}
constexpr Row b = slope_weights();

bool same(const Points& x, const Points& y) {
  return x.rows() == y.rows() && std::memcmp(x.data(), y.data(), x.size() * sizeof(double)) == 0;
}

/// out = base + scale * sum of the first `count` w_j u_j.
void combine(const Points& base, double scale, const Row& w, const std::array<Points, stages>& u, int count, Points& out) {
  Row weight;
  std::array<const double*, stages> term;
  for (int j = 0; j < count; ++j) weight[j] = scale * w[j], term[j] = u[j].data();
  kernels::combine(base.size(), base.data(), count, weight.data(), term.data(), out.data());
}

}  // namespace

Ros34pw2::Ros34pw2(const Lattice& lattice, int pins)
    : OneStep(Method::ros34pw2, lattice.points(), pins, 3), matrix_(lattice), implicit_(lattice), diagonal_(lattice.points()) {
  const int n = lattice.points();
  for (MarkedPoints* points : {&factored.x, &held_.x}) points->change().setZero(n, 3);
  for (Points* points : {&mass_, &damping_, &free_, &stage_x_, &stage_v_, &spring_, &outside_, &p_, &q_, &zero_, &pin_velocity_,
                         &pin_acceleration_, &pin_rate_, &correction_})
    points->setZero(n, 3);
  for (auto* list : {&x_, &v_})
    for (Points& u : *list) u.setZero(n, 3);
}

void Ros34pw2::factorize(const Body& body) {
  const double g = gamma * factored.h;
  for (int axis = 0; axis < 3; ++axis)
    for (int p = 0; p < body.points(); ++p) {
      free_(p, axis) = body.pinned[p] ? 0 : 1;
      mass_(p, axis) = free_(p, axis) * body.mass[p];
      damping_(p, axis) = free_(p, axis) * body.damping[p];
    }
  diagonal_ = body.mass / (g * g) + body.damping / g;
  assemble(body, *factored.x, {.per_time = 1 / g}, diagonal_, matrix_);
  matrix_.factor();
  held_ = factored;
  version_ = body.version;
  ++factorizations_;
}

void Ros34pw2::use_factor(const Body& body, double h, const Points& x) {
  if (factored.h != h || factored.uses >= most_uses) {
    factored.x.change() = x;
    factored.h = h;
    factored.uses = 0;
  }
  if (held_.h != h || version_ != body.version || !same(*held_.x, *factored.x)) factorize(body);
  ++factored.uses;
}

bool Ros34pw2::pins_move(const Equations& equations, double t, double h) {
  if (equations.around.pins.empty()) return false;
  pin_velocity_.setZero();
  equations.place_pins(t, stage_x_, pin_velocity_);
  const Body& body = equations.body;
  const bool dashpots = body.dashpots();
  if (dashpots) {
    pin_acceleration_.setZero();
    equations.place_pins(t + h, stage_x_, pin_acceleration_);
    pin_acceleration_ = (pin_acceleration_ - pin_velocity_) / h;
  }
  const auto zero = [](const Points& points) { return kernels::largest(points.size(), points.data()) == 0; };
  if (zero(pin_velocity_) && zero(pin_acceleration_)) return false;
  pin_rate_.setZero();
  body.subtract_product(*factored.x, {}, pin_velocity_, pin_rate_);
  if (dashpots) body.add_dashpot_force(*factored.x, pin_acceleration_, pin_rate_);
  return true;
}

/// Returns |R(iy)| of the stability function R(z) = (1 + p1 z + p2 z^2 + p3 z^3) / (1 - gamma z)^4, which is exp(z) to third order.
double Ros34pw2::kept(double y) {
  constexpr double p1 = 1 - 4 * gamma, p2 = 0.5 - 4 * gamma + 6 * gamma * gamma,
                   p3 = 1.0 / 6 - 2 * gamma + 6 * gamma * gamma - 4 * gamma * gamma * gamma;
  const double real = 1 - p2 * y * y, imaginary = y * (p1 - p3 * y * y), below = 1 + gamma * gamma * y * y;
  return std::sqrt(real * real + imaginary * imaginary) / (below * below);
}

Outcome Ros34pw2::attempt_in(const Equations& equations, double t, double h, Run& run) {
  return with_factor_of(run, false, [&] {
    const Body& body = equations.body;
    torques_ = body.dashpots() && equations.around.pins.empty();
    const State& motion = run.physical.motion;
    const double error = attempt(equations, t, h, motion);
    if (torques_) turn_by_torques(body, motion);
    torques_ = false;
    return error;
  });
}

/// Corrects the spin at the end of the step: the angular momentum becomes that of `state` plus the impulse of the outside torques.
void Ros34pw2::turn_by_torques(const Body& body, const State& state) {
  const RigidMotion before = rigid_motion(body.mass, state.x, state.v), now = rigid_motion(body.mass, x, v);
  const Vec3 lacking = now.inverse_inertia * (before.angular_momentum + given_ - now.angular_momentum);
  for (int p = 0; p < body.points(); ++p) set_row(v, p, row(v, p) + lacking.cross(row(x, p) - now.centre));
}

void Ros34pw2::add_torque(const Body& body, double weight, const Points& outside) {
  double total = 0;
  Vec3 centre = Vec3::Zero();
  for (int p = 0; p < body.points(); ++p) total += body.mass[p], centre += body.mass[p] * row(stage_x_, p);
  centre /= total;
  for (int p = 0; p < body.points(); ++p)
    given_ += weight * (row(stage_x_, p) - centre).cross(row(outside, p) - body.damping[p] * row(stage_v_, p));
}

double Ros34pw2::attempt(const Equations& equations, double t, double h, const State& state) {
  const auto& [body, around] = equations;
  use_factor(body, h, state.x);
  const double g = gamma * h;
  solutions_ = 0;
  given_.setZero();
  const bool moving = pins_move(equations, t, h), recording = ledger.recording();
  for (int i = 0; i < stages; ++i) {
    const double at = t + time[i] * h, ahead = h * time_gamma[i];
    combine(state.x, 1, a[i], x_, i, stage_x_);
    combine(state.v, 1, a[i], v_, i, stage_v_);
    if (i == 0) {
      spring_ = state.spring;
    } else {
      equations.place_pins(at, stage_x_, stage_v_);
      body.internal_force(stage_x_, spring_);
    }
    combine(zero_, 1 / h, c[i], x_, i, p_);
    combine(zero_, 1 / h, c[i], v_, i, q_);
    Points& x_i = x_[i];
    const Points& outside = equations.outside(at, outside_);
    x_i = spring_ + outside;
    if (torques_) add_torque(body, h * b[i], outside);
    if (around.ramped)
      for (Eigen::Index j = 0; j < x_i.size(); ++j) x_i(j) += ahead * around.ramp_rate(j, t);
    if (moving) x_i += ahead * pin_rate_;
    x_i = free_ * x_i + mass_ * (q_ + (stage_v_ + p_) * (1 / g));
    if (body.damped) x_i += damping_ * p_;
    if (body.dashpots()) add_dashpots(body, x_i);
    solutions_ += matrix_.solve(x_i);
    v_[i] = free_ * (x_i * (1 / g) - stage_v_ - p_);
    if (recording) record_stage(equations, h * b[i], at, ahead, i);
  }
  combine(state.x, 1, m, x_, stages, x);
  combine(state.v, 1, m, v_, stages, v);
  equations.place_pins(t + h, x, v);
  if (recording) record_ends(equations, t, h, state);
  combine(zero_, 1, e, x_, stages, error_);
  const double position = position_size(error_);
  combine(zero_, 1, e, v_, stages, error_);
  return worse(position, velocity_size(error_));
}

/// Adds the terms of the dashpots at the present stage to the right-hand side.
void Ros34pw2::add_dashpots(const Body& body, Points& right) {
  correction_.setZero();
  body.add_dashpot_force(stage_x_, stage_v_, correction_);
  outside_ = -free_ * (stage_v_ + p_);
  body.add_dashpot_force(*factored.x, outside_, correction_);
  right += free_ * correction_;
}

/// Records the spring forces that the slopes f + J U contain. In long steps the forces at the stages are not close to those of the
/// solution; with the forces of the slopes the pins receive what the free points lose, to rounding.
void Ros34pw2::record_stage(const Equations& equations, double weight, double at, double ahead, int i) {
  if (!equations.around.pins.empty()) {
    outside_ = x_[i] + ahead * pin_velocity_;
    correction_.setZero();
    equations.body.subtract_product(*factored.x, {}, outside_, correction_);
    if (equations.body.dashpots()) {
      equations.body.add_dashpot_force(stage_x_, stage_v_, correction_);
      outside_ = v_[i] + ahead * pin_acceleration_;
      equations.body.add_dashpot_force(*factored.x, outside_, correction_);
    }
    spring_ += correction_;
  }
  ledger.stage(equations, weight, at, stage_x_, spring_);
}

/// Velocities at the stages are no closer to the solution: the loss by damping is Simpson's rule over the cubic through both ends.
void Ros34pw2::record_ends(const Equations& equations, double t, double h, const State& state) {
  ledger.ends(equations, t, state.x, state.v, t + h, x, v);
  stage_v_ = (1.5 / h) * (x - state.x) - 0.25 * (state.v + v);
  stage_x_ = 0.5 * (state.x + x) + (h / 8) * (state.v - v);
  ledger.damp(equations, h / 6, state.x, state.v);
  ledger.damp(equations, h * 2 / 3, stage_x_, stage_v_);
  ledger.damp(equations, h / 6, x, v);
}

}  // namespace softffd
