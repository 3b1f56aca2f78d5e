#include "body/rigid_motion.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace softffd {

RigidMotion rigid_motion(const Scalars& mass, const Points& x, const Points& v) {
  double total = 0;
  Vec3 centre = Vec3::Zero(), momentum = Vec3::Zero(), angular = Vec3::Zero();
  for (int p = 0; p < mass.size(); ++p) {
    total += mass[p];
    centre += mass[p] * row(x, p);
    momentum += mass[p] * row(v, p);
  }
  centre /= total;
  const Vec3 velocity = momentum / total;
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  for (int p = 0; p < mass.size(); ++p) {
    const Vec3 arm = row(x, p) - centre;
    angular += mass[p] * arm.cross(row(v, p) - velocity);
    inertia += mass[p] * (arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose());
  }
  const double size = inertia.trace();
  if (!(size > 0)) return {centre, velocity, Vec3::Zero(), total};
  if (!(inertia.determinant() > 1e-12 * size * size * size)) inertia += 1e-12 * size * Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d inverse = inertia.inverse();
  return {centre, velocity, inverse * angular, total, angular, inverse};
}

double radius_about(const Vec3& centre, const Points& x) {
  double squared = 0;
  for (int p = 0; p < x.rows(); ++p) squared = std::max(squared, (row(x, p) - centre).squaredNorm());
  return std::sqrt(squared);
}

Vec3 second_order(const Vec3& turn, const Vec3& arm) {
  const double squared = turn.squaredNorm();
  if (squared == 0) return Vec3::Zero();
  const double root = std::sqrt(1 + squared);
  // cos = 1 / root, sin = |turn| / root; root - 1 without cancellation
  const double less = squared / (root + 1) / root;
  const Vec3 across = arm - turn * (turn.dot(arm) / squared);
  return -less * (turn.cross(arm) + across);
}

}  // namespace softffd
