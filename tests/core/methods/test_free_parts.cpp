/// Free pins: a rigid part that control points are bonded to.
#include <Eigen/Geometry>

#include "soft_bodies.hpp"

using namespace softffd;

namespace {

constexpr double heavy = 3, stiffness = 2e2;

/// Points of the face at the top of the unit cube, or of that at its bottom.
std::vector<int> face(const Lattice& lattice, bool top) {
  std::vector<int> points;
  for (int i = 0; i < lattice.counts[0]; ++i)
    for (int j = 0; j < lattice.counts[1]; ++j) points.push_back(lattice.index(i, j, top ? lattice.counts[2] - 1 : 0));
  return points;
}

Definition with_part(bool held, const Vec3& guide = Vec3::Zero(), double mass = heavy) {
  Definition definition = one_kilogram();
  definition.watch_energy = true;
  definition.pins = {{.points = face(definition.lattice, true), .origin = Vec3(0.6, 0.45, 1.2)}};
  definition.free = {{.pin = 0, .mass = mass, .inertia = mass * Vec3(0.1, 0.2, 0.25), .guide = guide}};
  if (held) definition.pins.push_back({.points = face(definition.lattice, false)});
  return definition;
}

SoftBody go_free(Method method, double h, double damping = 0) {
  Definition definition = with_part(false);
  definition.velocity = {0.3, -0.2, 0.1};
  definition.angular_velocity = {1, 2, 3};
  definition.stretch = {1.05, 1, 0.97};
  SoftBody body = soft_body(definition, stiffness);
  body.settings.method = method;
  body.settings.step = h;
  body.settings.internal_damping = damping;
  CHECK(body.initialize(0) == StepStatus::ok);
  return body;
}

/// Linear, and angular about the origin, of the object and the part, whose state has the points of the pin.
std::pair<Vec3, Vec3> momentum(const SoftBody& body) {
  const State& state = body.state();
  Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
  const std::vector<int> top = face(body.lattice(), true);
  for (int p = 0; p < state.x.rows(); ++p) {
    if (std::ranges::count(top, p)) continue;
    const Vec3 each = row(state.v, p) / double(state.x.rows());
    linear += each;
    angular += row(state.x, p).cross(each);
  }
  const double mass = heavy + double(top.size()) / double(state.x.rows());
  linear += mass * state.free[0].velocity;
  angular += state.free[0].position.cross(mass * state.free[0].velocity) + state.free[0].momentum;
  return {linear, angular};
}

double energy(const SoftBody& body) {
  const Readings now = body.readings();
  return now.kinetic_energy() + now.elastic_energy() + now.gravity_energy();
}

}  // namespace

TEST(object_and_part_keep_their_momenta_and_energy) {
  for (const double damping : {1e-3, 0.0}) {
    SoftBody body = go_free(Method::leapfrog, 1e-4, damping);
    const auto [linear, angular] = momentum(body);
    go(body, 100, 1e-2);
    const auto [linear1, angular1] = momentum(body);
    CHECK((linear1 - linear).norm() < 1e-12 * linear.norm());
    CHECK((angular1 - angular).norm() < 1e-12 * angular.norm());
  }
  SoftBody body = go_free(Method::leapfrog, 1e-4);
  const double first = energy(body);
  go(body, 100, 1e-2);
  CHECK(std::abs(energy(body) / first - 1) < 1e-4);
  const std::vector<int> top = face(body.lattice(), true);
  CHECK(std::abs((row(body.state().x, top.front()) - row(body.state().x, top.back())).norm() - std::sqrt(2.0)) < 0.1);
  const double side = (row(body.state().x, top[0]) - row(body.state().x, top[1])).norm();
  CHECK(std::abs(side - (row(body.state().x, top[1]) - row(body.state().x, top[2])).norm()) < 1e-12);
}

TEST(implicit_steps_of_a_part_come_to_explicit_ones) {
  for (const double damping : {0.0, 1e-3}) {
    SoftBody exact = go_free(Method::leapfrog, 2e-5, damping);
    go(exact, 10, 1e-2);
    double last = 1e300;
    for (const double h : {1e-3, 5e-4, 2.5e-4}) {
      SoftBody body = go_free(Method::sdirk2, h, damping);
      const Vec3 linear = momentum(body).first;
      const double first = energy(body);
      go(body, 10, 1e-2);
      const double place = (body.state().free[0].position - exact.state().free[0].position).norm();
      CHECK(place < 0.3 * last);
      CHECK((axes_of(body.state().free[0].orientation) - axes_of(exact.state().free[0].orientation)).norm() < 10 * place);
      CHECK((momentum(body).first - linear).norm() < 1e-9 * linear.norm());
      CHECK(energy(body) < first * (1 + 1e-6));
      last = place;
    }
    CHECK(last < 1e-5);
  }
}

TEST(a_mass_on_a_column_swings_with_the_columns_stiffness) {
  const auto body_of = [](Method method, double gravity, double h, double damping) {
    SoftBody body = soft_body(with_part(true, {0, 0, 1}, 100), 2e5);
    body.settings.mass = 1e-3;
    body.settings.gravity = {0, 0, gravity};
    body.settings.method = method;
    body.settings.step = h;
    body.settings.internal_damping = damping;
    CHECK(body.initialize(0) == StepStatus::ok);
    return body;
  };
  // a static run under the weight, heavily damped, tells the stiffness
  SoftBody still = body_of(Method::sdirk2, -1e-3, 1e-3, 0.05);
  const double rest = still.free_body(0).position.z();
  go(still, 40, 0.1);
  const double sag = rest - still.free_body(0).position.z();
  const double frequency = std::sqrt(1e-3 / sag), period = 2 * 3.14159265358979 / frequency;
  for (const Method method : {Method::leapfrog, Method::sdirk2}) {
    const int steps = method == Method::leapfrog ? 8000 : 500;
    const double h = period / 2 / steps;
    SoftBody body = body_of(method, -1e-3, h, 0);
    go(body, 1, steps * h);  // half a period: twice the sag
    const double deepest = rest - body.free_body(0).position.z();
    CHECK(std::abs(deepest / (2 * sag) - 1) < 1e-5);
    CHECK(std::abs(body.free_body(0).velocity.z()) < 3e-3 * frequency * sag);
  }
}
