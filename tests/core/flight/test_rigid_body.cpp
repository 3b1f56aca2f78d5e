#include "bodies.hpp"
#include "check.hpp"
#include "flight/rigid_body.hpp"
#include "model/rotation.hpp"

using namespace softffd;

namespace {

using Matrix = Eigen::Matrix3d;

struct Throw {
  Lattice lattice;
  Body body;
  Drive around;
  Points x, v;
  Equations equations() const { return {body, around}; }
};

/// Points of a lattice that turn with the spin and fly with the velocity; masses alike unless `uneven`.
Throw flying(const Lattice& lattice, const Vec3& velocity, const Vec3& spin, bool uneven = false) {
  const int n = lattice.points();
  Throw s{lattice, even_body(lattice, 0, 0.1 * n), no_forces(n), rest_positions(lattice), Points::Zero(n, 3)};
  const Vec3 middle = lattice.origin + 0.5 * lattice.size;
  for (int p = 0; p < n; ++p) {
    if (uneven) s.body.mass[p] += 0.03 * std::sin(3.0 * p);
    set_row(s.v, p, velocity + spin.cross(row(s.x, p) - middle));
  }
  return s;
}

Lattice slab() { return {{4, 3, 2}, Vec3(1, 2, 3), Vec3(1.0, 0.6, 0.2)}; }
Lattice column() { return {{3, 3, 5}, Vec3::Zero(), Vec3(0.4, 0.4, 1.3)}; }

RigidBody started(const Throw& s) {
  RigidBody body;
  body.start(s.equations(), 0, s.x, s.v);
  return body;
}

RigidState after(const Throw& s, double time, int steps) {
  RigidBody body = started(s);
  for (int i = 0; i < steps; ++i) CHECK(body.advance(time / steps) < 1e-12);
  return body.state();
}

double kinetic_energy(const RigidState& s, double mass) {
  return 0.5 * mass * s.velocity.squaredNorm() + 0.5 * s.spin.dot(s.angular_momentum);
}

double farthest(const Vec3& a, const Vec3& b) { return (a - b).norm(); }

}  // namespace

/// L = I1 w + (I3 - I1) w3 e: the axis e goes round L with L / I1, and the body about it with w3 (1 - I3 / I1), w3 being constant.
TEST(symmetric_top_moves_as_the_exact_solution) {
  const Vec3 spin(3, -4, 10), axis = Vec3::UnitZ();
  const Throw s = flying(column(), Vec3(1, 2, 3), spin);
  double across = 0, along = 0;
  for (int p = 0; p < s.body.points(); ++p) {
    const Vec3 arm = row(s.x, p) - 0.5 * s.lattice.size;
    across += s.body.mass[p] * (arm[1] * arm[1] + arm[2] * arm[2]);
    along += s.body.mass[p] * (arm[0] * arm[0] + arm[1] * arm[1]);
  }
  const Vec3 momentum(across * spin[0], across * spin[1], along * spin[2]);
  for (int steps : {1, 7, 50}) {
    const double time = steps * 0.05;
    const RigidState end = after(s, time, steps);
    for (int a = 0; a < 3; ++a) {
      const Vec3 self = rotated(axis * (spin[2] * (1 - along / across) * time), Vec3::Unit(a));
      CHECK_NEAR(farthest(end.turn.col(a), rotated(momentum * (time / across), self)), 0, 1e-13 * (1 + steps));
    }
    CHECK_NEAR(farthest(end.centre, 0.5 * s.lattice.size + time * Vec3(1, 2, 3)), 0, 1e-13);
  }
}

TEST(torque_free_flight_keeps_every_bit_of_the_angular_momentum_and_its_energy) {
  const Throw s = flying(slab(), Vec3::Zero(), Vec3(0.01, 20, 0.02), true);  // about the middle axis, which is unstable
  RigidBody body = started(s);
  const RigidState begin = body.state();
  const double mass = s.body.mass.sum(), energy = kinetic_energy(begin, mass);
  double tilt = 0;
  for (int i = 0; i < 10'000; ++i) {
    CHECK(body.advance(0.01) < 1e-12);
    const RigidState now = body.state();
    CHECK(now.angular_momentum == begin.angular_momentum);
    CHECK_NEAR(kinetic_energy(now, mass), energy, 1e-11 * energy);
    tilt = std::max(tilt, farthest(now.turn.col(1), begin.turn.col(1)));
  }
  CHECK(tilt > 1.9);  // it tumbles
  CHECK_NEAR((body.state().turn.transpose() * body.state().turn - Matrix::Identity()).norm(), 0, 1e-15 * 10);
}

/// With the potential -f (c + R r) of a constant force on a point energy is conserved; with damping in proportion to mass nothing but the
/// rate of decay changes.
TEST(constant_force_on_a_point_keeps_the_energy) {
  Throw s = flying(slab(), Vec3(1, 0, 2), Vec3(3, 1, -2), true);
  const Vec3 force(5, -3, 8);
  const int corner = s.body.points() - 1;
  set_row(s.around.force, corner, force);
  RigidBody body = started(s);
  const RigidState begin = body.state();
  const double mass = s.body.mass.sum();
  const Vec3 arm = row(s.x, corner) - begin.centre;
  const auto energy = [&](const RigidState& now) { return kinetic_energy(now, mass) - force.dot(now.centre + now.turn * arm); };
  for (int i = 0; i < 100; ++i) {
    CHECK(body.advance(0.02) < 1e-12);
    CHECK_NEAR(energy(body.state()), energy(begin), 1e-12 * kinetic_energy(body.state(), mass));
  }
}

TEST(damping_in_proportion_to_mass_decays_exponentially) {
  Throw s = flying(slab(), Vec3(1, 0, 2), Vec3(3, 1, -2), true);
  const double rate = 2, time = 0.7, left = std::exp(-rate * time);
  s.body.damping = rate * s.body.mass;
  s.body.damped = true;
  const RigidState begin = started(s).state(), end = after(s, time, 3);
  CHECK_NEAR(farthest(end.velocity, left * begin.velocity), 0, 1e-14);
  CHECK_NEAR(farthest(end.angular_momentum, left * begin.angular_momentum), 0, 1e-14);
  CHECK_NEAR(farthest(end.centre, begin.centre + (1 - left) / rate * begin.velocity), 0, 1e-14);
}

/// Momentum is the time integral of the force; accelerations are derivatives of velocities.
TEST(forces_are_followed_in_time) {
  Throw s = flying(slab(), Vec3::Zero(), Vec3(1, 2, 3), true);
  s.around.ramped = s.around.bent = true;
  for (int p = 0; p < s.body.points(); ++p)
    for (int a = 0; a < 3; ++a) {
      s.around.force(p, a) = std::sin(p + a);
      s.around.force_rate(p, a) = std::cos(2.0 * p + a);
      s.around.force_bend[0](p, a) = std::sin(3.0 * p + a);
      s.around.force_bend[1](p, a) = 5 * std::cos(4.0 * p + a);
    }
  s.body.damping = 0.2 + 0.1 * s.body.mass;
  const double time = 0.3, h = 1e-4, mass = s.body.mass.sum();
  const RigidState undamped = after(s, time, 1);
  const Vec3 begin = after(s, 0, 1).velocity;
  for (int a = 0; a < 3; ++a) {
    const auto sum = [&](const Points& forces) { return forces.col(a).sum(); };
    const double impulse =
        time * (sum(s.around.force) +
                time * (sum(s.around.force_rate) / 2 + time * (sum(s.around.force_bend[0]) / 6 + time * sum(s.around.force_bend[1]) / 24)));
    CHECK_NEAR(mass * (undamped.velocity - begin)[a], impulse, 1e-13);
  }
  s.body.damped = true;
  const RigidState start = after(s, 0, 1), before = after(s, time - h, 2), here = after(s, time, 2), behind = after(s, time + h, 2);
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
  for (int p = 0; p < s.body.points(); ++p) {
    const Vec3 arm = here.turn * (row(s.x, p) - start.centre);
    Vec3 f = row(s.around.force, p) - s.body.damping[p] * (here.velocity + here.spin.cross(arm));
    for (int a = 0; a < 3; ++a) f[a] += s.around.ramp(p + a * s.body.points(), time);
    force += f;
    torque += arm.cross(f);
  }
  CHECK_NEAR(farthest(mass * here.acceleration, force), 0, 1e-12);
  CHECK_NEAR(farthest((behind.velocity - before.velocity) / (2 * h), here.acceleration), 0, 1e-7);
  CHECK_NEAR(farthest((behind.angular_momentum - before.angular_momentum) / (2 * h), torque), 0, 1e-7);
  CHECK_NEAR(farthest((behind.spin - before.spin) / (2 * h), here.spin_rate), 0, 1e-6);
}
