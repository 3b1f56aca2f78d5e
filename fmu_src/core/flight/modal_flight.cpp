#include "flight/modal_flight.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "body/rigid_motion.hpp"
#include "contact/free/solid_samples.hpp"
#include "contact/surface/tangents.hpp"
#include "contact/tolerances.hpp"
#include "flight/attitude.hpp"
#include "model/rotation.hpp"

namespace softffd {

namespace {

using Matrix = Eigen::Matrix3d;
using Complex = std::complex<double>;

/// Modes whose frequencies are closer than this many spins are coupled by Coriolis' force. Between other modes the force averages out to a
/// fraction of about one over this number.
constexpr double linked = 30;
/// Largest number of advances towards a possible touch.
constexpr int most_advances = 200;
constexpr double anharmonic = 10;
/// A gap below this fraction of the box is a touch.
constexpr double near_enough = 1e-9;

/// Returns e^-a for a >= 0, the same on every platform.
double decayed(double a) {
  if (a > 700) return 0;
  int halvings = 0;
  for (; a > 0.03; a /= 2) ++halvings;
  double r = 1 - a * (1 - a / 2 * (1 - a / 3 * (1 - a / 4 * (1 - a / 5 * (1 - a / 6)))));
  for (; halvings > 0; --halvings) r *= r;
  return r;
}

double shortest_cell_side(const Lattice& lattice) {
  double shortest = lattice.largest_side();
  for (int axis = 0; axis < 3; ++axis) shortest = std::min(shortest, lattice.size[axis] / (lattice.counts[axis] - 1));
  return shortest;
}

Complex turned(double angle) {
  const SineCosine r = sine_cosine(angle);
  return {r.cosine, r.sine};
}

/// Bounds for a free body in flight for some time [s]: of its acceleration relative to `other` [m/s2] and of its spin [rad/s]. Its loads
/// grow linearly, so that they are largest at one of the ends.
struct FreeBounds {
  double acceleration, spin;
};
FreeBounds bounds_of(const FreeMotion& free, double t, double time, const Vec3& other) {
  const FreeState state = free.at(t);
  FreeState later = state;
  later.time += time;
  const double torque = std::max(free.loads(state).torque.norm(), free.loads(later).torque.norm());
  return {std::max((other - free.acceleration(state)).norm(), (other - free.acceleration(later)).norm()),
          free.inverse_inertia(state).norm() * (state.momentum.norm() + time * torque)};
}

}  // namespace

ModalFlight::ModalFlight(const Lattice& lattice)
    : rest_(rest_positions(lattice)), cell_(shortest_cell_side(lattice)), x_(rest_), v_(rest_), outside_(rest_) {}

bool ModalFlight::possible(const Body& body) {
  if (version_ != body.version) {
    modes_.make(body, rest_);
    version_ = body.version;
    if (modes_.valid()) {
      for (Eigen::VectorXd* values : {&q_, &q_rate_, &held_, &old_, &old_rate_, &amplitude_}) values->setZero(modes_.count());
      displacement_.setZero(3 * body.points());
      rate_ = displacement_;
      way_.setZero(body.points());
    }
  }
  return modes_.valid();
}

void ModalFlight::enter(const Equations& equations, double t, const State& state) {
  const Body& body = equations.body;
  const RigidMotion motion = rigid_motion(body.mass, state.x, state.v);
  const int n = body.points();
  Matrix covariance = Matrix::Zero();
  for (int p = 0; p < n; ++p) covariance += body.mass[p] * (row(state.x, p) - motion.centre) * row(modes_.arms, p).transpose();
  attitude_ = rotation_next_to(covariance);
  Matrix inertia = Matrix::Zero();
  Vec3 momentum = Vec3::Zero();
  double kinetic = 0;
  for (int p = 0; p < n; ++p) {
    const Vec3 r = row(modes_.arms, p), y = attitude_.transpose() * (row(state.x, p) - motion.centre),
               w = attitude_.transpose() * (row(state.v, p) - motion.velocity);
    inertia += body.mass[p] * (r.dot(y) * Matrix::Identity() - y * r.transpose());
    momentum += body.mass[p] * r.cross(w);
    set_row(x_, p, y);
    set_row(v_, p, w);
    const Vec3 own = row(state.v, p) - motion.velocity - motion.spin.cross(row(state.x, p) - motion.centre);
    kinetic += 0.5 * body.mass[p] * own.squaredNorm();
  }
  const Vec3 spin = inertia.inverse() * momentum;
  for (int p = 0; p < n; ++p)
    for (int axis = 0; axis < 3; ++axis) {
      displacement_[p + axis * n] = body.mass[p] * (x_(p, axis) - modes_.arms(p, axis));
      rate_[p + axis * n] = body.mass[p] * (v_(p, axis) - spin.cross(row(x_, p))[axis]);
    }
  q_.noalias() = modes_.shape.transpose() * displacement_;
  q_rate_.noalias() = modes_.shape.transpose() * rate_;
  deformation_ = kinetic + body.elastic_energy(state.x);
  const Vec3 inner = inner_momentum(spin.norm());
  const Vec3 rigid_spin = attitude_ * (modes_.inertia.inverse() * (attitude_.transpose() * motion.angular_momentum - inner));
  for (int p = 0; p < n; ++p) {
    const Vec3 arm = attitude_ * row(modes_.arms, p);
    set_row(x_, p, motion.centre + arm);
    set_row(v_, p, motion.velocity + rigid_spin.cross(arm));
  }
  body_.start(equations, t, x_, v_, attitude_ * inner);
  begin_ = rigid_ = body_.state();
  t0_ = t_ = t;
}

double ModalFlight::energy() const { return 0.5 * (q_rate_.squaredNorm() + (modes_.frequency * q_.array()).square().sum()); }

double ModalFlight::energy_missed() const { return std::abs(deformation_ - energy()); }

double ModalFlight::energy_after(double time) const {
  double sum = 0;
  for (int a = 0; a < q_.size(); ++a) {
    const double w = modes_.frequency[a] * q_[a];
    sum += 0.5 * (q_rate_[a] * q_rate_[a] + w * w) * decayed(2 * modes_.decay[a] * time);
  }
  return sum;
}

double ModalFlight::memory() const {
  const double slowest = modes_.count() > 0 ? modes_.decay.minCoeff() : 0;
  return slowest > 0 ? 1 / slowest : std::numeric_limits<double>::infinity();
}

double ModalFlight::remaining(double time) const { return decayed(time / memory()); }

double ModalFlight::mean_frequency() const {
  double sum = 0, weighted = 0;
  for (int a = 0; a < q_.size(); ++a) {
    const double omega = modes_.frequency[a], w = omega * q_[a], energy = q_rate_[a] * q_rate_[a] + w * w;
    sum += energy;
    weighted += energy * omega * omega;
  }
  return sum > 0 ? std::sqrt(weighted / sum) : 0;
}

/// The relative change of a frequency is about (amplitude / cell size)^2; measured on soft boxes, ten times that.
double ModalFlight::neglected_rate() const {
  const double squared = (q_.squaredNorm() + (q_rate_.array() / modes_.frequency).square().sum()) / modes_.mass;
  return anharmonic * squared * std::sqrt(2 * energy() / modes_.mass) / (cell_ * cell_);
}

/// Returns the speed that drag, the sum of - d u, gives a point of the rigid body while these amplitudes arise [m/s]: zero if drag is
/// proportional to mass.
double ModalFlight::pulled_on(const Body& body, const Eigen::VectorXd& amplitudes) {
  displacement_.noalias() = modes_.shape * amplitudes;
  v_ = Eigen::Map<const Points>(displacement_.data(), body.points(), 3).colwise() * body.damping;
  Vec3 turning = Vec3::Zero();
  for (int p = 0; p < body.points(); ++p) turning += row(modes_.arms, p).cross(row(v_, p));
  return v_.colwise().sum().matrix().norm() / modes_.mass + modes_.radius * (modes_.inertia.inverse() * turning).norm();
}

double ModalFlight::neglected_way(const Equations& equations, double until) {
  if (!modes_.damped_unevenly) return 0;
  load(equations, t_, held_);
  const auto from_held = (q_ - held_).array();
  amplitude_ = q_rate_.array() / modes_.frequency;
  const double way = std::sqrt((modes_.uneven * from_held).square().sum() + (modes_.uneven * amplitude_.array()).square().sum());
  return way + until * (pulled_on(equations.body, q_) + pulled_on(equations.body, amplitude_));
}

/// Returns the mean angular momentum of the vibrations, in body axes: that of pairs of modes of nearly the same frequency [kg m2/s].
Vec3 ModalFlight::inner_momentum(double spin) const {
  const double reach = linked * std::max(1.0, spin);
  Vec3 sum = Vec3::Zero();
  const int count = modes_.count();
  for (int a = 0; a < count; ++a)
    for (int b = a + 1; b < std::min(count, a + 1 + Modes::most_neighbours) && modes_.frequency[b] - modes_.frequency[a] < reach; ++b)
      sum -= modes_.coupling(a, b) * (q_[a] * q_rate_[b] - q_[b] * q_rate_[a]);
  return sum;
}

double ModalFlight::least_gap(const Body& body, const HalfSpace& obstacle, bool still) {
  double least = std::numeric_limits<double>::infinity();
  const Vec3 normal = (rigid_.turn * attitude_).transpose() * obstacle.normal;
  const double centre = obstacle.gap(rigid_.centre);
  heights_.resize(way_.size());
  for (int p = 0; p < way_.size(); ++p) heights_[p] = normal.dot(row(modes_.arms, p)) - (still ? 0 : way_[p]);
  for (int p = 0; !body.samples && p < way_.size(); ++p) least = std::min(least, heights_[p]);
  for (int s = 0; body.samples && s < body.samples->count(); ++s) least = std::min(least, body.samples->at(s, heights_.data()));
  return centre + least;
}

ModalFlight::Nearing ModalFlight::nearing(const Body& body, const Plane& plane, bool still) {
  const HalfSpace obstacle = plane.at(t_);
  const Vec3 relative = rigid_.velocity - obstacle.material_velocity(rigid_.centre);
  const double far = (rigid_.centre - obstacle.point).norm() + modes_.radius, turning = obstacle.spin.norm();
  const double speed = std::max(0.0, -obstacle.normal.dot(relative)) + (rigid_.spin - obstacle.spin).norm() * modes_.radius;
  const double acceleration = (rigid_.acceleration - plane.acceleration).norm() + rigid_.spin_rate.norm() * modes_.radius +
                              plane.angular_acceleration.norm() * far + turning * (2 * relative.norm() + turning * far);
  return {least_gap(body, obstacle, still), speed, acceleration};
}

/// As `nearing`, for a solid obstacle: bounds for any direction and for at most `time` [s].
ModalFlight::Nearing ModalFlight::nearing_solid(const Body& body, const Plane& solid, bool still, double time) const {
  const SolidPose pose = solid.pose_at(t_);
  const HalfSpace facing = tangent(solid, pose, rigid_.centre);
  double gap = facing.gap(rigid_.centre) - modes_.radius - (still ? 0 : way_.maxCoeff());
  if (gap < modes_.radius) {  // near the solid the sum of the bounds is too coarse
    const Matrix axes = rigid_.turn * attitude_;
    gap = std::numeric_limits<double>::infinity();
    for (int s = 0; s < body.samples->count(); ++s) {
      const Vec3 place = rigid_.centre + axes * body.samples->at(s, modes_.arms);
      gap = std::min(gap, tangent(solid, pose, place).gap(place) - (still ? 0 : body.samples->at(s, way_.data())));
    }
  }
  const double velocity = (rigid_.velocity - pose.velocity).norm() + rigid_.spin.norm() * modes_.radius;
  const double turning = rigid_.spin_rate.norm() * modes_.radius;
  if (solid.own) {
    const auto [acceleration, spin] = bounds_of(*solid.own, t_, time, rigid_.acceleration);
    return {gap, velocity + spin * solid.size(), acceleration + turning};
  }
  return {gap, velocity + pose.spin.norm() * solid.size(),
          (rigid_.acceleration - solid.acceleration).norm() + turning + solid.angular_acceleration.norm() * solid.size()};
}

/// As `nearing`, between a free obstacle and another one, for at most `time` [s].
ModalFlight::Nearing ModalFlight::nearing_free(const Plane& free, const Plane& other, double time) const {
  const SolidPose pose = free.pose_at(t_);
  const HalfSpace facing = facing_half_space(other, t_, pose.point);
  const Vec3 relative = pose.velocity - facing.material_velocity(pose.point);
  const auto [acceleration, spin] = bounds_of(*free.own, t_, time, other.acceleration);
  const double far = (pose.point - other.point).norm() + free.size(), turning = facing.spin.norm();
  return {own_gap(free, other, t_), relative.norm() + (spin + turning) * free.size(),
          acceleration + other.angular_acceleration.norm() * far + turning * (2 * relative.norm() + turning * far)};
}

double ModalFlight::until_touch(const Equations& equations, double most, double shortest, bool still) {
  for (int a = 0; a < q_.size(); ++a) {
    const double w = q_rate_[a] / modes_.frequency[a];
    amplitude_[a] = std::sqrt(q_[a] * q_[a] + w * w);
  }
  way_.matrix().noalias() = modes_.excursion * amplitude_;
  double gone = 0;
  const std::vector<Plane>& planes = equations.around.planes;
  for (int i = 0; i < most_advances && gone < most; ++i) {
    const double longest = body_.longest_step();
    double step = most - gone;
    bool touch = false;
    const auto near = [&](const Nearing& at) {
      const double gap = at.gap - near_enough * equations.body.length;
      if (gap <= 0) touch = true;
      const double fastest = at.speed + std::sqrt(at.speed * at.speed + 2 * at.acceleration * std::max(gap, 0.0));
      if (fastest > 0) step = std::min(step, 2 * gap / fastest);
    };
    for (const Plane& plane : planes) {
      near(plane.solid() ? nearing_solid(equations.body, plane, still, most - gone) : nearing(equations.body, plane, still));
      for (const Plane& other : planes)
        if (plane.own && !other.own) near(nearing_free(plane, other, most - gone));
    }
    if (touch) break;
    const bool cut = step > longest;
    if (cut) step = longest;
    if (!std::isfinite(body_.advance(step))) break;
    gone = step == most - gone ? most : gone + step;
    rigid_ = body_.state();
    t_ = t0_ + gone;
    if (step < shortest && !cut) break;
  }
  return gone;
}

/// Computes the static deformations of the modes under the forces in the frame, (modes).
void ModalFlight::load(const Equations& equations, double t, Eigen::VectorXd& held) {
  const Body& body = equations.body;
  const Points& outside = equations.outside(t, outside_);
  const Matrix axes = rigid_.turn * attitude_;
  const int n = body.points();
  for (int p = 0; p < n; ++p) {
    const Vec3 arm = axes * row(modes_.arms, p), turning = rigid_.spin.cross(arm);
    Vec3 force = row(outside, p) - body.mass[p] * (rigid_.acceleration + rigid_.spin_rate.cross(arm) + rigid_.spin.cross(turning));
    if (body.damped) force -= body.damping[p] * (rigid_.velocity + turning);
    const Vec3 inside = axes.transpose() * force;
    for (int axis = 0; axis < 3; ++axis) displacement_[p + axis * n] = inside[axis];
  }
  held.noalias() = modes_.shape.transpose() * displacement_;
  held.array() /= modes_.frequency.square();
}

/// Advances the modes by `time` [s]; before and after, q_ is relative to a static deformation.
void ModalFlight::vibrate(double time) {
  const int count = modes_.count();
  const double link = linked * spin_.norm();
  for (int first = 0; first < count;) {
    int last = first + 1;
    while (last < count && modes_.frequency[last] - modes_.frequency[last - 1] < link && last - first < Modes::most_neighbours) ++last;
    if (last - first > 1) {
      turn_group(first, last - first, time, spin_);
    } else {
      const double gamma = modes_.decay[first], omega = modes_.frequency[first];
      const double ringing = std::sqrt(std::max(0.0, omega * omega - gamma * gamma)), kept = decayed(gamma * time);
      const Complex turn = turned(ringing * time);
      const double over = ringing > 0 ? turn.imag() / ringing : time, q = q_[first], rate = q_rate_[first];
      q_[first] = kept * (q * turn.real() + (rate + gamma * q) * over);
      q_rate_[first] = kept * (rate * turn.real() - (gamma * rate + omega * omega * q) * over);
    }
    first = last;
  }
}

/// Advances a group of modes of neighbouring frequencies, among which Coriolis' force turns the vibration from one into another.
void ModalFlight::turn_group(int first, int count, double time, const Vec3& spin) {
  constexpr int most = Modes::most_neighbours;
  using Square = Eigen::Matrix<Complex, Eigen::Dynamic, Eigen::Dynamic, 0, most, most>;
  using Column = Eigen::Matrix<Complex, Eigen::Dynamic, 1, 0, most, 1>;
  const double mean = modes_.frequency.segment(first, count).mean();
  Square h(count, count);
  Column z(count);
  for (int a = 0; a < count; ++a) {
    const double omega = modes_.frequency[first + a];
    z[a] = {q_[first + a], -q_rate_[first + a] / omega};
    h(a, a) = omega - mean;
    for (int b = a + 1; b < count; ++b) {
      h(a, b) = Complex(0, spin.dot(modes_.coupling(first + a, first + b)));
      h(b, a) = std::conj(h(a, b));
    }
  }
  const Eigen::SelfAdjointEigenSolver<Square> solver(h);
  Column y = solver.eigenvectors().adjoint() * z;
  for (int a = 0; a < count; ++a) {
    double gamma = 0;  // decay of the coupled vibration, to first order
    for (int b = 0; b < count; ++b) gamma += std::norm(solver.eigenvectors()(b, a)) * modes_.decay[first + b];
    y[a] *= turned((solver.eigenvalues()[a] + mean) * time) * decayed(gamma * time);
  }
  z = solver.eigenvectors() * y;
  for (int a = 0; a < count; ++a) {
    q_[first + a] = z[a].real();
    q_rate_[first + a] = -modes_.frequency[first + a] * z[a].imag();
  }
}

void ModalFlight::leave(const Equations& equations, State& state) {
  const Body& body = equations.body;
  const RigidState end = rigid_;
  const int n = body.points();
  if (t_ > t0_) {
    rigid_ = begin_;
    load(equations, t0_, held_);
    q_ -= held_;
    rigid_ = end;
    spin_ = 0.5 * attitude_.transpose() * (begin_.spin + end.turn.transpose() * end.spin);
    vibrate(t_ - t0_);
    load(equations, t_, held_);
    q_ += held_;
  }
  displacement_.noalias() = modes_.shape * q_;
  rate_.noalias() = modes_.shape * q_rate_;
  const Matrix axes = end.turn * attitude_;
  Matrix inertia = Matrix::Zero();
  Vec3 inside = Vec3::Zero();
  for (int p = 0; p < n; ++p) {
    const Vec3 y = row(modes_.arms, p) + Vec3(displacement_[p], displacement_[p + n], displacement_[p + 2 * n]);
    const Vec3 w(rate_[p], rate_[p + n], rate_[p + 2 * n]);
    inertia += body.mass[p] * (y.squaredNorm() * Matrix::Identity() - y * y.transpose());
    inside += body.mass[p] * y.cross(w);
    set_row(x_, p, y);
    set_row(v_, p, w);
  }
  const Vec3 spin = inertia.inverse() * (axes.transpose() * end.angular_momentum - inside);
  for (int p = 0; p < n; ++p) {
    const Vec3 y = row(x_, p), w = spin.cross(y) + row(v_, p);
    set_row(state.x, p, end.centre + axes * y);
    set_row(state.v, p, end.velocity + axes * w);
  }
  body.internal_force(state.x, state.spring);
}

void ModalFlight::remember() {
  old_ = q_;
  old_rate_ = q_rate_;
}

double ModalFlight::difference() const {
  const double rates = (q_rate_ - old_rate_).squaredNorm(), stretches = ((q_ - old_).array() * modes_.frequency).square().sum();
  return std::sqrt((rates + stretches) / modes_.mass);
}

}  // namespace softffd
