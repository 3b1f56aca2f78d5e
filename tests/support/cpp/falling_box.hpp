/// A box in implicit contact, and a run of it that is held at every step against what must be true.
#pragma once
#include <cstring>

#include "bodies.hpp"
#include "check.hpp"
#include "contact/implicit/implicit_contact.hpp"
#include "methods/leapfrog.hpp"

namespace softffd {

inline constexpr double g = 9.81;

/// One kilogram in points of equal mass, a box of one metre, falling.
struct FallingBox {
  explicit FallingBox(double k, int planes, Lattice lattice = {}) : lattice(lattice), body(even_body(lattice, k)) {
    around.planes.resize(planes);
    pull({0, 0, -g});
  }

  void pull(const Vec3& gravity) {
    for (int axis = 0; axis < 3; ++axis) around.force.col(axis) = gravity[axis] * body.mass;
  }
  /// The ground is inclined by so many degrees, which friction of 0.4 holds up to 21.8. Returns the acceleration that it leaves.
  double incline(double degrees) {
    const double angle = degrees * M_PI / 180;
    around.planes[0].friction = 0.4;
    pull(g * Vec3(std::sin(angle), 0, -std::cos(angle)));
    return std::max(0.0, g * (std::sin(angle) - 0.4 * std::cos(angle)));
  }

  void damp(double d) {
    body.damping = d;
    body.damped = d > 0;
  }

  void turn(const Vec3& w) {
    const Vec3 centre(0.5, 0.5, 0.5);
    for (int p = 0; p < body.points(); ++p) set_row(state.x, p, centre + rotated(w, row(state.x, p) - centre));
  }

  void throw_at(const Vec3& velocity, const Vec3& spin) {
    const Vec3 centre = mean(state.x);
    for (int p = 0; p < body.points(); ++p) set_row(state.v, p, velocity + spin.cross(row(state.x, p) - centre));
  }

  /// Fixes the points of a layer k to a frame at its centre.
  void pin_layer(int k) {
    std::vector<int> points;
    for (int j = 0; j < lattice.counts[1]; ++j)
      for (int i = 0; i < lattice.counts[0]; ++i) points.push_back(lattice.index(i, j, k));
    around.pins.push_back(pin_points(body, state.x, points));
  }

  static Vec3 mean(const Points& values) { return values.colwise().mean().matrix().transpose(); }
  Vec3 momentum() const { return (state.v.colwise() * body.mass).colwise().sum().matrix().transpose(); }

  /// Without that of the outside forces.
  double energy() const { return 0.5 * (body.mass * state.v.square().rowwise().sum()).sum() + body.elastic_energy(state.x); }

  double least_gap(double t) const {
    double least = 1;
    for (const Plane& plane : around.planes)
      for (int p = 0; p < body.points(); ++p)
        if (!body.pinned[p] && !body.samples) least = std::min(least, plane.at(t).gap(row(state.x, p)));
    for (const Plane& plane : around.planes)
      for (int s = 0; body.samples && s < body.samples->count(); ++s)
        least = std::min(least, plane.at(t).gap(body.samples->at(s, state.x)));
    return least;
  }

  Lattice lattice;
  Body body;
  Drive around = no_forces(lattice.points());
  State state = at_rest(lattice);
};

/// Runs a scene and holds every step against what must be true of it: nothing behind a plane, and the balances of momentum and energy.
struct CheckedRun {
  explicit CheckedRun(const FallingBox& scene)
      : method(scene.lattice, int(scene.around.planes.size()), int(scene.around.pins.size()), scene.body.samples.get()) {
    exchange.planes.resize(scene.around.planes.size());
    exchange.pins.resize(scene.around.pins.size());
  }
  /// At once, in steps of h over a time [s].
  CheckedRun(FallingBox& scene, double h, double duration, bool sdirk2 = false) : CheckedRun(scene) {
    this->sdirk2 = sdirk2;
    CHECK(run(scene, h, duration));
  }

  bool step(FallingBox& scene, double h) {
    for (auto* list : {&exchange.planes, &exchange.pins}) std::fill(list->begin(), list->end(), Impulse{});
    exchange.work = exchange.dissipated = 0;
    if (time == 0) scene.body.internal_force(scene.state.x, scene.state.spring);
    const Points x0 = scene.state.x;
    const Vec3 momentum = scene.momentum();
    const double energy = scene.energy();
    const Equations equations{scene.body, scene.around};
    const StepStatus status = sdirk2 ? method.advance_sdirk2(equations, time, h, {}, true, scene.state, exchange)
                                     : method.advance(equations, time, h, true, scene.state, exchange);
    CHECK(status == StepStatus::ok);
    if (status != StepStatus::ok) return false;
    time += h;
    CHECK(scene.least_gap(time) >= -(scene.body.samples ? 2e-14 : 4e-16) * (1 + scene.state.x.abs().maxCoeff()));
    Vec3 missing = scene.momentum() - momentum;
    double size = 0;
    for (const auto* list : {&exchange.planes, &exchange.pins})
      for (const Impulse& impulse : *list) missing += impulse.force, size += impulse.force.norm();
    for (int p = 0; p < scene.body.points(); ++p)
      missing -= h * row(scene.around.force, p) - scene.body.damping[p] * (row(scene.state.x, p) - row(x0, p));
    CHECK_NEAR(missing.norm(), 0.0, 1e-13 * (1 + size));
    const double outside = (scene.around.force * (scene.state.x - x0)).sum();
    const double gained = scene.energy() - energy - outside - exchange.work + exchange.dissipated;
    CHECK_NEAR(gained, 0.0, 1e-13 * (1 + energy + std::abs(exchange.work)));
    loss = exchange.dissipated;
    return true;
  }

  bool run(FallingBox& scene, double h, double duration) {
    for (int i = 0; i < std::lround(duration / h); ++i)
      if (!step(scene, h)) return false;
    return true;
  }
  Vec3 force(int plane, double h) const { return exchange.planes[plane].force / h; }

  ImplicitContact method;
  Exchange exchange;
  double time = 0, loss = 0;
  bool sdirk2 = false;
};

/// Steps each by a method of its own have the bits of those of one: the state has all that the next step begins with.
inline void check_nothing_is_kept(FallingBox scene) {
  FallingBox again = scene;
  CheckedRun used(again);
  for (int i = 0; i < 30; ++i) {
    CheckedRun one(scene);
    CHECK(one.method.advance({scene.body, scene.around}, 0.01 * i, 0.01, false, scene.state, one.exchange) == StepStatus::ok);
    CHECK(used.method.advance({again.body, again.around}, 0.01 * i, 0.01, true, again.state, used.exchange) == StepStatus::ok);
  }
  CHECK(std::memcmp(scene.state.x.data(), again.state.x.data(), sizeof(double) * 192) == 0);
  CHECK(std::memcmp(scene.state.v.data(), again.state.v.data(), sizeof(double) * 192) == 0);
}

/// Steps over 0.1 s converge to explicit ones of 2e-6 s with first order.
inline void check_convergence_to_explicit_contact(FallingBox start) {
  Body& body = start.body;
  body.inverse_mass = 1 / body.mass.replicate(3, 1);
  body.damping_rate = body.damping.replicate(3, 1) * body.inverse_mass;
  body.internal_force(start.state.x, start.state.spring);
  Run run;
  run.physical.exchange.planes.resize(1);
  run.physical.motion = start.state;
  if (body.samples) {
    SurfaceRows& rows = run.physical.surface;
    rows.drift = rows.close = std::vector<Count>(64, -1);
    rows.drift_friction = rows.close_friction = Points::Zero(64, 3);
  }
  Leapfrog leapfrog(64, 1);
  CHECK(leapfrog.advance(Model(body), start.around, {0, 0, 2e-6, 50000}, run).status == StepStatus::ok);
  std::vector<double> error;
  for (const double h : {4e-4, 2e-4, 1e-4}) {
    FallingBox scene = start;
    CheckedRun runner(scene);
    CHECK(runner.run(scene, h, 0.1));
    error.push_back(distance(scene.state.x, run.physical.motion.x));
  }
  for (int i = 0; i < 2; ++i) CHECK_NEAR(std::log2(error[i] / error[i + 1]), 1.0, 0.15);
}

}  // namespace softffd
