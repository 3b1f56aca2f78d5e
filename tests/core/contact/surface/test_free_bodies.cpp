/// Obstacles with a mass of their own: what they and the object exchange is kept, and two of them meet as mechanics says.
#include "surface_bodies.hpp"

using namespace softffd;

namespace {

/// The object and a free box or sphere that comes at it.
struct Meeting {
  Method method = Method::leapfrog;
  double step = 1e-4, stiffness = 2e3, friction = 0.3, mass = 0.7, internal_damping = 0;
  Vec3 inertia = Vec3(0.02, 0.03, 0.04), guide = Vec3::Zero();
  bool sphere = false;
  Vec3 gravity = Vec3::Zero();

  SoftBody body() const {
    const Sphere object{.level = 2, .stiffness = stiffness, .damping = 0, .planes = 1};
    Definition definition = object.definition();
    definition.solids = true;
    definition.watch_energy = true;
    definition.free = {{.plane = 0, .mass = mass, .inertia = inertia, .guide = guide}};
    SoftBody body = object.body(definition);
    body.settings.gravity = gravity;
    body.settings.method = method;
    body.settings.step = step;
    body.settings.internal_damping = internal_damping;
    PlaneMotion& obstacle = body.settings.planes[0];
    obstacle = {.point = {0.6, 0.45, 1.06}, .velocity = {0.4, 0.2, -2}, .angular_velocity = {0.5, 1, 2}, .friction = friction};
    if (!guide.isZero(0)) obstacle.velocity = {0, 0, -2};
    if (sphere)
      obstacle.radius = 0.2;
    else
      obstacle.sides = {0.6, 0.5, 0.3}, obstacle.rotation = {0.1, 0.2, 0.3};
    return body;
  }
};

struct Momentum {
  Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
};

Momentum momentum(const SoftBody& body) {
  const State& state = body.state();
  Momentum sum;
  for (int p = 0; p < state.x.rows(); ++p) {
    const Vec3 each = row(state.v, p) / double(state.x.rows());
    sum.linear += each;
    sum.angular += row(state.x, p).cross(each);
  }
  for (const FreeState& each : state.free) {
    const Vec3 own = body.settings.free[0].mass * each.velocity;
    sum.linear += own;
    sum.angular += each.position.cross(own) + each.momentum;
  }
  return sum;
}

double energy(const SoftBody& body) {
  const Readings now = body.readings();
  return now.kinetic_energy() + now.elastic_energy() + now.gravity_energy();
}

}  // namespace

TEST(explicit_steps_keep_momentum_and_angular_momentum_of_both) {
  for (const bool sphere : {false, true})
    for (const double mass : {1e-3, 0.7, 1e3}) {
      if (sphere && mass != 0.7) continue;
      Meeting meeting{.mass = mass, .inertia = mass / 0.7 * Vec3(0.02, 0.03, 0.04), .sphere = sphere};
      SoftBody body = meeting.body();
      CHECK(body.initialize(0) == StepStatus::ok);
      const Momentum begin = momentum(body);
      const double first = energy(body);
      const Vec3 before = body.state().free[0].velocity, turning = body.state().free[0].momentum;
      go(body, 20, 5e-3);
      const double exchanged = mass * (body.state().free[0].velocity - before).norm();
      CHECK(exchanged > 0.1 * std::min(mass, 1.0));
      CHECK((body.state().free[0].momentum - turning).norm() > 1e-3 * turning.norm());
      const Momentum end = momentum(body);
      CHECK((end.linear - begin.linear).norm() < 1e-12 * exchanged + 1e-15 * begin.linear.norm() * 1e3);
      CHECK((end.angular - begin.angular).norm() < 1e-11 * exchanged + 1e-15 * begin.angular.norm() * 1e3);
      CHECK(energy(body) < first * (1 + 1e-4));
      const double balance = energy(body) - first - body.readings().work() + body.readings().dissipated_energy();
      CHECK(std::abs(body.readings().work()) < 2e-3 * first);
      CHECK(std::abs(balance) < 2e-3 * first);
    }
}

TEST(a_guided_body_goes_along_its_guide_alone) {
  for (const Method method : {Method::leapfrog, Method::sdirk2}) {
    SoftBody body = Meeting{.method = method, .step = 5e-4, .internal_damping = 1e-3, .guide = {0, 0, 1}}.body();
    body.initialize(0);
    go(body, 20, 5e-3);
    const FreeState& state = body.state().free[0];
    CHECK(state.velocity.head<2>().isZero(0) && state.momentum.isZero(0) && state.velocity.z() > -2);
  }
}

TEST(a_run_that_begins_again_has_the_same_bits) {
  const Sphere object{.level = 2, .damping = 0, .planes = 2};
  Definition definition = object.definition();
  definition.solids = true;
  definition.free = {{.plane = 1, .mass = 60, .inertia = {1, 1, 1}, .guide = {0, 0, 1}}};
  SoftBody body = object.body(definition);
  body.settings.internal_damping = 2e-4;
  body.settings.method = Method::leapfrog;
  body.settings.planes[0].friction = 0.5;
  body.settings.planes[1] = {.point = {0.5, 0.5, 1.2}, .velocity = {0, 0, -1}, .friction = 0, .radius = 0.2};
  std::vector<Points> ends;
  for (const int steps : {30, 7}) {
    CHECK(body.initialize(0) == StepStatus::ok);
    go(body, 7, 5e-3);
    ends.push_back(body.positions());
    go(body, steps - 7, 5e-3);
    for (int q = 0; q < 2 && steps > 7; ++q) CHECK(body.readings().plane_reaction(q).norm() > 0);  // in contact with both
  }
  CHECK((ends[0] == ends[1]).all());
}
