#include <memory>

#include "check.hpp"
#include "icosphere.hpp"
#include "soft_body.hpp"

using namespace softffd;

namespace {

/// A sphere of radius 0.4 in the middle of the unit box, of 1 kg in equal masses, above the ground.
struct Sphere {
  int level = 2;
  double height = 0;  ///< of its lowest point, were it round [m]
  double stiffness = 2e3, damping = 0.3, friction = 0.4;
  Vec3 velocity = Vec3::Zero();
  int planes = 1;

  Samples samples() const { return {Basis::bezier, {}, icosphere(level, 0.4, {0.5, 0.5, 0.5})}; }
  SoftBody body() const {
    Definition definition;
    definition.mass.assign(64, 1.0 / 64);
    definition.planes = planes;
    definition.offset = {0, 0, height - 0.1};
    definition.velocity = velocity;
    definition.samples = std::make_shared<Samples>(samples());
    SoftBody body(definition);
    body.settings.stiffness = {stiffness, stiffness, stiffness};
    body.settings.damping = damping;
    body.settings.gravity = {0, 0, -9.81};
    for (PlaneMotion& plane : body.settings.planes) plane.friction = friction;
    return body;
  }
};

double lowest(const Samples& samples, const SoftBody& body) {
  double least = 1e300;
  for (int s = 0; s < samples.count(); ++s) least = std::min(least, samples.at(s, body.state().x).z());
  return least;
}

Vec3 centre(const SoftBody& body) { return body.state().x.colwise().mean().matrix().transpose(); }

}  // namespace

TEST(a_sphere_rests_on_its_own_surface) {
  const double heights[] = {0.3773, 0.3939, 0.3984, 0.3995};
  for (int level = 1; level <= 3; ++level) {
    const Sphere sphere{.level = level, .height = 0.05};
    const Samples samples = sphere.samples();
    SoftBody body = sphere.body();
    body.settings.step = 1e-3;
    CHECK(body.initialize(0) == StepStatus::ok);
    double deepest = 0;
    for (int i = 0; i < 600; ++i) {
      CHECK(body.advance(0.01) == StepStatus::ok);
      deepest = std::min(deepest, lowest(samples, body));
    }
    CHECK_NEAR(centre(body).z(), heights[level - 1], 1e-3);
    CHECK_NEAR(body.readings().plane_reaction(0).z(), -9.81, 1e-6);
    CHECK(deepest >= -1e-12);
    CHECK(body.run().contacts[0] > 0);
    std::printf("  level %d: centre %.5f, force %.9f, deepest %.2g, contacts %d, corner %.4f\n", level, centre(body).z(),
                body.readings().plane_reaction(0).z(), deepest, int(body.run().contacts[0]), body.state().x.col(2).minCoeff());
  }
}
