#include "flight/floating_frame.hpp"

#include "body/rigid_motion.hpp"
#include "methods/traits.hpp"
#include "ros34pw2_scenes.hpp"

using namespace softffd;

namespace {

/// A slab of uneven masses that turns about all axes; `loaded`: gravity and a force on one corner.
Scene turning(double stiffness, bool loaded = false, bool ramped = false, double damping = 0) {
  const Lattice lattice{{4, 3, 2}, Vec3::Zero(), Vec3(1.0, 0.6, 0.3)};
  const int n = lattice.points();
  Scene s{lattice, even_body(lattice, stiffness), no_forces(n), at_rest(lattice), 0};
  s.body.damping.setConstant(damping);
  for (int p = 0; p < n; ++p) s.body.mass[p] = 0.1 + 0.03 * std::sin(3.0 * p);
  set_rates(s.body);
  if (loaded) {
    s.around.force.col(2) = -9.81 * s.body.mass;
    set_row(s.around.force, n - 1, row(s.around.force, n - 1) + Vec3(2, -1, 3));
  }
  s.around.ramped = ramped;
  if (ramped) set_row(s.around.force_rate, 0, Vec3(5, 10, -5));
  for (int p = 0; p < n; ++p) set_row(s.start.v, p, Vec3(1, 0, 2) + Vec3(3, 6, -2).cross(row(s.start.x, p) - 0.5 * lattice.size));
  return s;
}

/// The method with the implicit one that it works with.
struct Flight {
  Ros34pw2 deformation;
  FloatingFrame method;
  explicit Flight(const Lattice& lattice) : deformation(lattice, 0), method(lattice, deformation) {
    method.time_scale = deformation.time_scale = Scalars::Constant(3 * lattice.points(), 1e-4);
  }
};

struct Flown : Result {
  double error = 0;  ///< sum of the steps' estimates [m]
};

Flown run(const Scene& s, OneStep& method, double duration, int steps, bool watch = true) {
  Flown r{begin(s)};
  const Equations equations{s.body, s.around};
  const double h = duration / steps;
  for (int i = 0; i < steps; ++i) {
    method.ledger.open(equations, watch, true);
    r.error += method.attempt(equations, r.state.time, h, r.state);
    accept(method, s, h, r);
  }
  return r;
}

/// By the method itself.
Flown fly(const Scene& s, double duration, int steps, bool watch = true) {
  Flight frame(s.lattice);
  return run(s, frame.method, duration, steps, watch);
}

/// 0.5 s of explicit steps that resolve everything.
Flown resolved(const Scene& s) {
  Dop853 explicit_steps(s.body.points(), 0);
  return run(s, explicit_steps, 0.5, 2000);
}

RigidMotion motion(const Scene& s, const State& state) { return rigid_motion(s.body.mass, state.x, state.v); }

}  // namespace

TEST(stiffer_bodies_come_nearer) {
  double before = 0;
  for (const double stiffness : {1e4, 1e5, 1e6}) {
    const Scene s = turning(stiffness);
    const double difference = distance(fly(s, 0.5, 25).state.x, fly(s, 0.5, 400).state.x);
    if (before > 0) CHECK(difference < before / 5);
    before = difference;
  }
}

/// Gravity's and the corner's work is the change of their potential, which is none of the ledger's.
TEST(what_the_deformation_loses_is_booked_as_dissipated) {
  for (const bool ramped : {false, true})
    for (const double damping : {0.0, 0.05}) {
      const Scene s = turning(1e5, true, ramped, damping);
      const Flown r = fly(s, 0.5, 50);
      const double constant = (s.around.force * (r.state.x - s.start.x)).sum(), before = conserved(s, s.start).energy;
      CHECK_NEAR(conserved(s, r.state).energy + r.exchange.dissipated, before + constant + r.exchange.work, 1e-12 * before);
      CHECK(r.exchange.dissipated > 0);
      CHECK((r.exchange.work != 0) == ramped);
      const Exchange unwatched = fly(s, 0.1, 10, false).exchange;
      CHECK(unwatched.dissipated == 0 && unwatched.work == 0);
    }
}

/// In the limit of stiffness: rigid, they would do the same.
TEST(work_of_ramps_is_that_of_explicit_steps) {
  const Scene s = turning(1e6, true, true);
  const double explicit_work = resolved(s).exchange.work;
  CHECK_NEAR(fly(s, 0.5, 50).exchange.work, explicit_work, 1e-5 * std::abs(explicit_work));
}

/// From a state without vibrations; a body so soft that the change of its shape counts, by 3e-5 m if it were left out of the moments. Much
/// finer steps resolve vibrations, which leaves 1e-7 m.
TEST(change_of_shape_is_followed_beyond_first_order) {
  Scene s = turning(1e4, true, true);
  Flight frame(s.lattice);  // the same for runs that go back in time and take other steps
  const auto flown = [&](double duration, int steps) { return run(s, frame.method, duration, steps).state; };
  s.start = flown(0.5, 25);
  const Points exact = flown(0.4, 2560).x;
  const double coarse = distance(flown(0.4, 20).x, exact), fine = distance(flown(0.4, 40).x, exact);
  CHECK(coarse < 2e-6);
  CHECK(fine < coarse / 2);
}

TEST(one_factor_serves_many_steps_however_the_body_turns) {
  const Scene s = turning(1e6);
  Flight frame(s.lattice);
  run(s, frame.method, 2, 200);
  CHECK(frame.deformation.factorizations() == 200 / Ros34pw2::most_uses);
}

/// Fast against the step, its springs' vibrations end; the energy of the turning stays.
TEST(vibrations_end_and_the_rotation_stays) {
  Scene s = turning(1e6);
  for (int p = 0; p < s.body.points(); ++p) s.start.x(p, 0) += 1e-5 * std::cos(7.0 * p);
  s.body.internal_force(s.start.x, s.start.spring);
  const Flown few = fly(s, 0.1, 10), many = fly(s, 10, 1000);
  const double vibration = s.body.elastic_energy(s.start.x);
  CHECK_NEAR(few.exchange.dissipated, vibration, 0.5 * vibration);
  CHECK_NEAR(many.exchange.dissipated, few.exchange.dissipated, 1e-6 * conserved(s, s.start).energy);
}

/// A soft body that grows while it turns: Coriolis' force is by far the largest that is left out.
TEST(coriolis_force_on_the_deformation_is_part_of_the_error) {
  Scene s = turning(1);
  s.start.v += 0.3 * s.start.x;
  Flight frame(s.lattice);
  const double h = 1e-3, scale = traits(Method::floating_frame).tolerance_sum * frame.method.time_scale[0];
  const double error = run(s, frame.method, h, 1).error;
  const RigidMotion rigid = motion(s, s.start);
  double coriolis = 0;
  for (int p = 0; p < s.body.points(); ++p) {
    const Vec3 drift = row(s.start.v, p) - rigid.velocity - rigid.spin.cross(row(s.start.x, p) - rigid.centre);
    coriolis = std::max(coriolis, 2 * rigid.spin.cross(drift).norm());
  }
  CHECK(error > 0.95 * h * scale * coriolis && error < 1.5 * h * scale * coriolis);
}
