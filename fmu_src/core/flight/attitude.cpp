#include "flight/attitude.hpp"

#include <Eigen/Dense>

#include "model/rotation.hpp"

namespace softffd {

Eigen::Matrix3d rotation_next_to(const Eigen::Matrix3d& a) {
  Eigen::Matrix3d q = a / a.norm();
  if (!(q.determinant() > 1e-12)) return Eigen::Matrix3d::Identity();
  for (int i = 0; i < 30; ++i) {
    const Eigen::Matrix3d next = 0.5 * (q + q.inverse().transpose());
    const double change = (next - q).squaredNorm();
    q = next;
    if (change < 1e-20) break;
  }
  return q;
}

Eigen::Matrix3d rotation_by(const Vec3& turn) {
  Eigen::Matrix3d r;
  for (int axis = 0; axis < 3; ++axis) r.col(axis) = rotated(turn, Vec3::Unit(axis));
  return r;
}

}  // namespace softffd
