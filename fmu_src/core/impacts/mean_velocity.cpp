#include "impacts/mean_velocity.hpp"

#include <array>
#include <cmath>

#include "body/rigid_motion.hpp"
#include "flight/attitude.hpp"

namespace softffd {

namespace {

/// If the sine of the angle between two obstacles is below this value, they hold the body in one direction only [1].
constexpr double same_plane = 1e-6;

/// Returns the rotation vector of a rotation by at most some tenths of a radian, with a relative error of 1e-6.
Vec3 small_turn(const Eigen::Matrix3d& rotation) {
  const Vec3 sine = 0.5 * Vec3(rotation(2, 1) - rotation(1, 2), rotation(0, 2) - rotation(2, 0), rotation(1, 0) - rotation(0, 1));
  const double squared = sine.squaredNorm();
  return (1 + squared * (1.0 / 6 + squared * (3.0 / 40 + squared * 15.0 / 336))) * sine;
}

/// Orthogonal directions across the obstacles that were touched, at most three.
struct Across {
  std::array<Vec3, 3> normals;
  int count = 0;

  Across(const StepContext& context, const Exchange& before) {
    for (std::size_t q = 0; q < context.drive.planes.size() && count < 3; ++q) {
      if (context.run.physical.exchange.planes[q].force == before.planes[q].force) continue;
      if (context.drive.planes[q].solid()) {  // each of its contact constraints has its own normal
        count = 3;
        normals = {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
        return;
      }
      const Vec3 normal = along(context.drive.planes[q].at(context.run.physical.motion.time).normal);
      if (normal.norm() > same_plane) normals[count++] = normal.normalized();
    }
  }
  Vec3 along(Vec3 v) const {
    for (int i = 0; i < count; ++i) v -= normals[i].dot(v) * normals[i];
    return v;
  }
  /// Returns the part of a turn that changes no gap: the part about the normal if there is only one, else zero.
  Vec3 about(const Vec3& turn) const { return count == 1 ? Vec3(normals[0].dot(turn) * normals[0]) : Vec3(Vec3::Zero()); }
};

}  // namespace

void follow_mean_velocity(const StepContext& context, const PhysicalState& before, double h, bool along) {
  const Body& body = context.model.body;
  const State& from = before.motion;
  State& motion = context.run.physical.motion;
  const RigidMotion begin = rigid_motion(body.mass, from.x, from.v), end = rigid_motion(body.mass, motion.x, motion.v);
  Eigen::Matrix3d turned = Eigen::Matrix3d::Zero();
  for (int p = 0; p < body.points(); ++p)
    turned += body.mass[p] * (row(motion.x, p) - end.centre) * (row(from.x, p) - begin.centre).transpose();
  const Eigen::Matrix3d actual = rotation_next_to(turned), wanted = rotation_by(0.5 * h * (begin.spin + end.spin));
  Eigen::Matrix3d correction = wanted * actual.transpose();
  Vec3 centre = begin.centre + 0.5 * h * (begin.velocity + end.velocity);
  if (along) {
    const Across across(context, before.exchange);
    if (across.count == 0) return;
    correction = rotation_by(across.about(small_turn(correction)));
    centre = end.centre + across.along(centre - end.centre);
  }
  const bool turns = (correction - Eigen::Matrix3d::Identity()).norm() > 1e-14;
  for (int p = 0; p < body.points(); ++p) {
    const Vec3 arm = row(motion.x, p) - end.centre;
    set_row(motion.x, p, centre + (turns ? Vec3(correction * arm) : arm));
  }
}

}  // namespace softffd
