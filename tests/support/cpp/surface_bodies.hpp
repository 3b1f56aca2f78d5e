/// Bodies whose surface meets planes: as a component has them, without files.
#pragma once
#include <algorithm>
#include <memory>

#include "icosphere.hpp"
#include "soft_bodies.hpp"

namespace softffd {

/// A sphere of radius 0.4 in the middle of the unit box, of 1 kg in equal masses, above the ground.
struct Sphere {
  int level = 2;
  double height = 0;  ///< of its lowest point, were it round [m]
  double stiffness = 2e3, damping = 0.3, friction = 0.4;
  Vec3 velocity = Vec3::Zero();
  int planes = 1;

  Samples samples() const { return {Basis::bezier, {}, icosphere(level, 0.4, {0.5, 0.5, 0.5})}; }
  Definition definition() const {
    Definition definition = one_kilogram({4, 4, 4}, planes);
    definition.offset = {0, 0, height - 0.1};
    definition.velocity = velocity;
    definition.samples = std::make_shared<Samples>(samples());
    return definition;
  }
  SoftBody body(const Vec3& spin = Vec3::Zero()) const {
    Definition spinning = definition();
    spinning.angular_velocity = spin;
    return body(spinning);
  }
  SoftBody body(const Definition& definition) const {
    SoftBody body = soft_body(definition, stiffness);
    body.settings.damping = damping;
    body.settings.gravity = {0, 0, -9.81};
    for (PlaneMotion& plane : body.settings.planes) plane.friction = friction;
    return body;
  }
};

/// Height of the lowest sample [m].
inline double lowest(const Samples& samples, const SoftBody& body) {
  double least = 1e300;
  for (int s = 0; s < samples.count(); ++s) least = std::min(least, samples.at(s, body.state().x).z());
  return least;
}

/// Of mass [m].
inline Vec3 centre(const SoftBody& body) { return body.state().x.colwise().mean().matrix().transpose(); }

/// A sphere that is thrown onto the ground with spin, in steps of h; a second plane comes to meet it, and turns.
inline SoftBody tumbling(double h, int planes = 1, double damping = 0) {
  Sphere sphere{.level = 2, .height = 0.1, .damping = damping, .friction = 0.5, .velocity = {1, 0.3, -1}, .planes = planes};
  SoftBody body = sphere.body(Vec3(0.4, 3, 0.7));
  body.settings.step = h;
  if (planes > 1) body.settings.planes[1] = {{1.6, 0, 0}, {-1, 0.2, 0.3}, {-0.2, 0, 0}, {0, 0, 0.3}, 0.3, false};
  return body;
}

/// A cube of 1 kg with samples all over its faces, at rest on the ground, in the middle of a box that is larger by 0.05 all round.
inline SoftBody cube(int planes, double stiffness, int side = 8) {
  std::vector<Vec3> places;
  for (int axis = 0; axis < 3; ++axis)
    for (const double face : {0.05, 0.95})
      for (int i = 0; i < side; ++i)
        for (int j = 0; j < side; ++j) {
          Vec3 place;
          place[axis] = face;
          place[(axis + 1) % 3] = 0.05 + 0.9 * i / (side - 1);
          place[(axis + 2) % 3] = 0.05 + 0.9 * j / (side - 1);
          places.push_back(place);
        }
  Definition definition = one_kilogram({4, 4, 4}, planes);
  definition.offset = {0, 0, -0.05};
  definition.samples = std::make_shared<Samples>(Basis::bezier, definition.lattice, places);
  return soft_body(definition, stiffness);
}

/// Gravity, where the ground is turned by this angle about y [m/s2].
inline Vec3 inclined(double degrees) {
  const double angle = degrees * 3.14159265358979323846 / 180;
  return 9.81 * Vec3(std::sin(angle), 0, -std::cos(angle));
}

}  // namespace softffd
