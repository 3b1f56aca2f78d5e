/// A free body in flight, against closed forms.
#include "model/free_body.hpp"

#include <Eigen/Geometry>

#include "check.hpp"

using namespace softffd;

namespace {

constexpr double equal = 0.3, axial = 0.5;
const FreeBody top{.mass = 2, .inertia = {equal, equal, axial}};

/// The orientation of a symmetric top that begins in the world's axes: it turns about its angular momentum L by |L| t / A, and about its
/// own axis by what its spin along that is more.
Eigen::Matrix3d exact(const Vec3& momentum, double t) {
  const double own = momentum.z() * (1 / axial - 1 / equal) * t;
  return (Eigen::AngleAxisd(momentum.norm() / equal * t, momentum.normalized()) * Eigen::AngleAxisd(own, Vec3::UnitZ())).toRotationMatrix();
}

}  // namespace

TEST(a_spinning_top_flies_as_euler_says) {
  std::vector<FreeState> states(1);
  FreeMotion body(top, states, 0);
  body.load({.force = {0, 0, -20}, .mass = 2}, 0);
  states[0].velocity = {1, 0, 3};
  states[0].momentum = {0.9, -0.4, 1.5};
  const double t = 10 / body.spin(states[0]).norm();
  FreeState by_steps = states[0];
  for (int i = 1; i <= 100; ++i) by_steps = body.flown(by_steps, t * i / 100);
  for (const FreeState& end : {body.at(t), by_steps}) {
    CHECK((axes_of(end.orientation) - exact(states[0].momentum, t)).norm() < 1e-8);
    CHECK((end.momentum - states[0].momentum).isZero(0));
    CHECK((end.position - Vec3(t, 0, 3 * t - 5 * t * t)).norm() < 1e-12);
  }
  CHECK(std::abs(body.kinetic_energy(body.at(t)) - body.kinetic_energy(states[0]) + 20 * body.at(t).position.z()) < 1e-8);
}
