#include "kit/tumbling.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "kit/outlook.hpp"
#include "kit/thresholds.hpp"
#include "model/arithmetic.hpp"

namespace softffd {

namespace thresholds {

/// Angle that a body turns through at least in the rest of the run before its turning can multiply errors [rad].
constexpr double least_turn = 3;
/// A mean growth up to this factor is that of a body which turns about a stable axis; estimates of errors leave room for as much [1].
constexpr double stable_growth = 5;
/// Largest angle of a step of the rigid body [rad], and largest number of its steps: longer motions are taken to repeat themselves.
constexpr double tumbling_angle = 0.2;
constexpr double most_tumbling_steps = 2048;
/// The growth is found anew after this fraction of the rest of the run [1].
constexpr double tumbling_renewal = 1.0 / 4;
/// Largest factor of growth [1]: errors of rounding have then become as large as the body.
constexpr double largest_growth = 1 / rounding;

}  // namespace thresholds

namespace {

namespace use = thresholds;
using Matrix = Eigen::Matrix3d;

/// Angular momentum of a rigid body in its principal axes, and what errors of its attitude have become at the end of the motion.
struct Top {
  Vec3 inverse_inertia, momentum;
  Matrix rows = Matrix::Identity();  ///< N, in rows

  /// Turns the body by h [s] about one axis; backwards with its errors, if h is negative.
  void turn(int axis, double h) {
    const int one = (axis + 1) % 3, other = (axis + 2) % 3;
    const double half = 0.5 * h * inverse_inertia[axis] * momentum[axis], scale = 1 / (1 + half * half);
    const double cosine = (1 - half * half) * scale, sine = 2 * half * scale;
    if (h < 0) {
      const double shear = -h * inverse_inertia[axis] * scale;
      const Vec3 across = shear * Vec3::Unit(axis).cross(momentum);
      const Vec3 weights = rows.col(axis);
      rows += weights * across.transpose();
      const Vec3 first = rows.col(one), second = rows.col(other);
      rows.col(one) = cosine * first + sine * second;
      rows.col(other) = cosine * second - sine * first;
    }
    const double first = momentum[one], second = momentum[other];
    momentum[one] = cosine * first + sine * second;
    momentum[other] = cosine * second - sine * first;
  }
  void step(double h) {
    for (const int axis : {0, 1}) turn(axis, 0.5 * h);
    turn(2, h);
    for (const int axis : {1, 0}) turn(axis, 0.5 * h);
  }
  /// The largest singular value of N, whose others are about 1 and its inverse: the flow keeps volumes.
  double growth() const { return std::sqrt(std::max(1.0, rows.squaredNorm() - 2)); }
};

/// Returns the rotation vector that takes the body from one state to another, by displacements [rad].
Vec3 turn_between(const Scalars& mass, const Points& from, const Points& to) {
  return rigid_motion(mass, from, to).spin - rigid_motion(mass, from, from).spin;
}

/// Returns how long errors of the attitude can grow: to the end of the run, or until drag has taken the spin [s].
double time_left(const StepContext& context) { return std::min(left_of_run(context), context.model.longest_lasting()); }

}  // namespace

Growth tumbling_growth(const RigidMotion& motion, double time) {
  const Eigen::SelfAdjointEigenSolver<Matrix> axes(motion.inverse_inertia);
  const Matrix to_axes = axes.eigenvectors().transpose();
  Top top{axes.eigenvalues(), to_axes * motion.angular_momentum};
  if (to_axes.determinant() < 0) top.momentum = -top.momentum;  // left-handed axes: the motion of the mirror image
  const double fastest = std::sqrt(top.inverse_inertia.maxCoeff() * motion.angular_momentum.dot(motion.spin));
  const double wanted = std::ceil(fastest * time / use::tumbling_angle);
  if (!(wanted > 0)) return {};
  const double steps = std::min(wanted, use::most_tumbling_steps), h = time / wanted;
  for (int i = 0; i < steps; ++i) top.step(h);
  double sum = 0, largest = 1;
  for (int i = 0; i < steps && sum < steps * use::largest_growth; ++i) {
    top.step(-h);
    const double growth = top.growth();
    sum += growth;
    largest = std::max(largest, growth);
  }
  const auto whole = [&](double growth) { return std::clamp(growth * (wanted / steps), 1.0, use::largest_growth); };
  return {whole(sum / steps), whole(largest), top.rows * to_axes};
}

double tumbling_growth(const StepContext& context) {
  const Drive& around = context.drive;
  if (!around.pins.empty() || !around.planes.empty()) return 1;
  Tumbling& kept = context.run.control.tumbling;
  const State& motion = context.run.physical.motion;
  if (motion.time < kept.until) return kept.growth;
  const double left = time_left(context);
  const RigidMotion rigid = rigid_motion(context.model.body.mass, motion.x, motion.v);
  kept.until = motion.time + use::tumbling_renewal * left;
  kept.growth = rigid.spin.norm() * left > use::least_turn ? tumbling_growth(rigid, left).mean : 1;
  if (kept.growth <= use::stable_growth) kept.growth = 1;
  if (kept.growth > 1) kept.error = std::max(kept.error, use::rounding * kept.growth * 2 * radius_about(rigid.centre, motion.x));
  return kept.growth;
}

Growth growth_from(const StepContext& context, const State& state) {
  if (!(tumbling_growth(context) > 1)) return {};
  return tumbling_growth(rigid_motion(context.model.body.mass, state.x, state.v), time_left(context));
}

double turned_apart(const StepContext& context, const State& state, const Points& other) {
  if (!(tumbling_growth(context) > 1)) return 0;
  const Scalars& mass = context.model.body.mass;
  const double radius = radius_about(rigid_motion(mass, state.x, state.v).centre, state.x);
  return radius * (growth_from(context, state).now * turn_between(mass, state.x, other)).norm();
}

double drifted_apart(const StepContext& context, const State& a, const State& b) {
  const Body& body = context.model.body;
  const double growth = body.damped ? tumbling_growth(context) : 1;
  if (!(growth > 1)) return 0;
  const RigidMotion of_a = rigid_motion(body.mass, a.x, a.v), of_b = rigid_motion(body.mass, b.x, b.v);
  const double lag = (of_b.inverse_inertia * (of_a.angular_momentum - of_b.angular_momentum)).norm();
  const double turn = turn_between(body.mass, b.x, a.x).norm() + lag / of_b.spin.norm();
  return radius_about(of_b.centre, b.x) * (growth * turn + lag * time_left(context));
}

}  // namespace softffd
