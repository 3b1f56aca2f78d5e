/// A box of springs that falls, spins, slides or rests on planes: as a component has it, without files.
#pragma once
#include <algorithm>
#include <functional>

#include "soft_bodies.hpp"

namespace softffd {

struct StiffBox {
  double stiffness = 1e7, damping = 0;  ///< [N/m], [N s/m] of a point
  double height = 0.5;                  ///< of the start above the plane [m]
  Vec3 velocity = Vec3::Zero(), spin = Vec3::Zero();
  double friction = 0.4, incline = 0, gravity = 9.81;  ///< incline: by which gravity is turned about y [rad]
  double tolerance = 1e-4, length = 0.4;               ///< length: of the run [s]
  std::array<int, 3> counts{4, 4, 4};
  double size = 1, mass = 1;
  double light_corner = 0;  ///< [kg]; 0: all points alike

  Definition definition() const {
    Definition d;
    d.lattice.counts = counts;
    d.lattice.origin = Vec3::Zero();
    d.lattice.size = Vec3::Constant(size);
    const int n = d.lattice.points();
    d.mass.assign(n, light_corner > 0 ? (mass - light_corner) / (n - 1) : mass / n);
    if (light_corner > 0) d.mass[0] = light_corner;
    d.planes = 1;
    d.offset = Vec3(0, 0, height);
    d.velocity = velocity;
    d.angular_velocity = spin;
    return d;
  }
  void set(Settings& settings) const {
    settings.mass = mass;
    settings.stiffness = {stiffness, stiffness, stiffness};
    settings.damping = damping;
    settings.gravity = gravity * Vec3(std::sin(incline), 0, -std::cos(incline));
    settings.planes[0].friction = friction;
    settings.tolerance = tolerance;
    settings.horizon = length;
  }
  SoftBody start() const { return start(definition()); }
  SoftBody start(const Definition& definition, const std::function<void(Settings&)>& more = {}) const {
    SoftBody body(definition);
    set(body.settings);
    if (more) more(body.settings);
    body.initialize(0);
    return body;
  }
};

inline Vec3 centre(const SoftBody& body, const StiffBox& box) {
  const std::vector<double> mass = box.definition().mass;
  Vec3 sum = Vec3::Zero();
  for (int p = 0; p < body.lattice().points(); ++p) sum += mass[p] * row(body.state().x, p);
  return sum / box.mass;
}

/// Steps of H until the end; false where one is refused. `seen` after each.
inline bool run_for(SoftBody& body, double length, double H, const std::function<void()>& seen = {}) {
  const Count steps = std::llround(length / H);
  for (Count i = 0; i < steps; ++i) {
    if (body.advance(H) != StepStatus::ok) return false;
    if (seen) seen();
  }
  return true;
}

}  // namespace softffd
