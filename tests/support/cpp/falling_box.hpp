/// A box in implicit contact, and a run of it that is held at every step against what must be true.
#pragma once
#include <cstring>

#include "check.hpp"
#include "contact/implicit/implicit_contact.hpp"

namespace softffd {

inline constexpr double g = 9.81;

/// One kilogram in points of equal mass, a box of one metre, falling.
struct FallingBox {
  explicit FallingBox(double k, int planes, Lattice lattice = {}) : lattice(lattice), body(make_body(lattice, k)) {
    const int n = lattice.points();
    around.planes.resize(planes);
    around.force.setZero(n, 3);
    around.force_rate.setZero(n, 3);
    around.force.col(2) = -g * body.mass;
    state.x = rest_positions(lattice);
    state.v.setZero(n, 3);
    state.spring.setZero(n, 3);
  }

  static Body make_body(const Lattice& lattice, double k) {
    const int n = lattice.points();
    Body body{Springs(lattice, Topology::distinct), Scalars::Constant(n, 1.0 / n), Scalars::Zero(n), std::vector<bool>(n, false)};
    body.springs.set_stiffness({k, k, k}, {});
    return body;
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
    Pin pin;
    for (int j = 0; j < lattice.counts[1]; ++j)
      for (int i = 0; i < lattice.counts[0]; ++i) pin.points.push_back(lattice.index(i, j, k));
    for (int p : pin.points) pin.position += row(state.x, p) / double(pin.points.size());
    for (int p : pin.points) {
      pin.local.push_back(row(state.x, p) - pin.position);
      body.pinned[p] = true;
    }
    around.pins.push_back(pin);
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
  Drive around;
  State state;
};

/// Runs a scene and holds every step against what must be true of it: nothing behind a plane, and the balances of momentum and energy.
struct CheckedRun {
  explicit CheckedRun(const FallingBox& scene) : method(scene.lattice, int(scene.around.planes.size()), scene.body.samples.get()) {
    exchange.planes.resize(scene.around.planes.size());
    exchange.pins.resize(scene.around.pins.size());
  }

  bool step(FallingBox& scene, double h) {
    for (auto* list : {&exchange.planes, &exchange.pins}) std::fill(list->begin(), list->end(), Impulse{});
    exchange.work = exchange.dissipated = 0;
    if (time == 0) scene.body.internal_force(scene.state.x, scene.state.spring);
    const Points x0 = scene.state.x;
    const Vec3 momentum = scene.momentum();
    const double energy = scene.energy();
    const StepStatus status = method.advance({scene.body, scene.around}, time, h, true, scene.state, exchange);
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

  Vec3 force(int plane, double h) const { return exchange.planes[plane].force / h; }

  ImplicitContact method;
  Exchange exchange;
  double time = 0, loss = 0;
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

}  // namespace softffd
