/// Flights by the modes of the rest shape, against leapfrog in steps that resolve every vibration.
#include "flight/modal_flight.hpp"

#include "body/rigid_motion.hpp"
#include "check.hpp"
#include "methods/leapfrog.hpp"
#include "stiff_box.hpp"

using namespace softffd;

namespace {

/// A body that spins and rings, with uneven masses; damped: unevenly.
struct Ringing {
  Lattice lattice{{4, 3, 2}, Vec3::Zero(), Vec3(1.0, 0.6, 0.3)};
  Model model{even_body(lattice, 1e6)};
  Drive drive = no_forces(lattice.points());
  Run run;

  explicit Ringing(double speed, bool damped = false) {
    const int n = lattice.points();
    for (int p = 0; p < n; ++p) model.body.mass[p] = 0.02 + 0.005 * std::sin(3.0 * p);
    if (damped)
      for (int p = 0; p < n; ++p) model.body.damping[p] = 0.05 * (p % 3);
    model.renew();
    drive.planes.resize(1);
    drive.force.col(2) = -9.81 * model.body.mass;
    State& motion = run.physical.motion = at_rest(lattice);
    motion.x.col(2) += 1;
    run.physical.exchange.planes.resize(1);
    for (int p = 0; p < n; ++p) {
      const Vec3 arm = row(motion.x, p) - Vec3(0.5, 0.3, 1.15);
      const Vec3 own = speed * Vec3(std::sin(5.0 * p), std::cos(3.0 * p), std::sin(2.0 * p + 1));
      set_row(motion.v, p, Vec3(1, 0, 0.5) + Vec3(2, 5, -1).cross(arm) + own);
    }
    model.body.internal_force(motion.x, motion.spring);
  }
  Equations equations() const { return {model.body, drive}; }
  /// The state after a flight of this time without obstacles.
  State flown(double time) {
    drive.planes.clear();
    ModalFlight flight(lattice);
    CHECK(flight.possible(model.body));
    State state = run.physical.motion;
    flight.enter(equations(), 0, state);
    CHECK(flight.until_touch(equations(), time, 0, false) == time);
    flight.leave(equations(), state);
    return state;
  }
  /// The same by leapfrog.
  State stepped(double time, double h) {
    drive.planes.clear();
    Run copy = run;
    Leapfrog leapfrog(lattice.points(), 0);
    const Count steps = std::llround(time / h);
    leapfrog.advance(model, drive, {0, 0, time / double(steps), steps}, copy);
    return copy.physical.motion;
  }
};

}  // namespace

TEST(going_into_the_frame_and_out_of_it_keeps_the_state) {
  Ringing r(0.5);
  const State begin = r.run.physical.motion, state = r.flown(0);
  CHECK(distance(state.x, begin.x) < 1e-14 && distance(state.v, begin.v) < 1e-11);
}

TEST(every_vibration_keeps_its_phase_while_the_body_turns) {
  for (const bool damped : {false, true}) {
    const double time = 0.05, speed = 0.02;  // a hundred vibrations and more
    const State fine = Ringing(speed, damped).stepped(time, 1e-6), flown = Ringing(speed, damped).flown(time);
    const double loud = distance(fine.v, Ringing(0, damped).stepped(time, 1e-6).v);
    CHECK(loud > 0.5 * speed && distance(flown.v, fine.v) < 0.04 * loud && distance(flown.x, fine.x) < 2e-6);
  }
}

TEST(what_unequal_damping_makes_of_one_mode_in_others_is_bounded_and_a_flight_ends_where_it_is_too_quick_to_follow) {
  for (const double share : {0.0, 1.0, 100.0, 1e4}) {
    const auto damped = [&] {
      Ringing r(0.02, true);
      r.model.body.damping *= share;
      r.model.renew();
      r.drive.planes.clear();
      return r;
    };
    const double time = 0.02;
    Ringing r = damped();
    ModalFlight flight(r.lattice);
    CHECK(flight.possible(r.model.body));
    State state = r.run.physical.motion;
    flight.enter(r.equations(), 0, state);
    const double bound = flight.neglected_way(r.equations(), time), flown = flight.until_touch(r.equations(), time, 0, false);
    flight.leave(r.equations(), state);
    const double missed = distance(state.x, damped().stepped(flown, 1e-6).x);
    CHECK(missed < bound + 2e-6);
    CHECK((share > 0) == (bound > 0));
    CHECK(flown > 0 && (flown == time) == (share < 1e4));
  }
}

TEST(a_flight_keeps_momentum_angular_momentum_and_energy) {
  Ringing r(0.5);
  r.drive.force.setZero();
  const State begin = r.run.physical.motion, end = r.flown(0.3);
  const Body& body = r.model.body;
  const RigidMotion before = rigid_motion(body.mass, begin.x, begin.v), after = rigid_motion(body.mass, end.x, end.v);
  CHECK((before.velocity - after.velocity).norm() < 1e-13);
  CHECK((before.angular_momentum - after.angular_momentum).norm() < 1e-13);
  const auto energy = [&](const State& state) {
    double kinetic = 0;
    for (int p = 0; p < body.points(); ++p) kinetic += 0.5 * body.mass[p] * row(state.v, p).squaredNorm();
    return kinetic + body.elastic_energy(state.x);
  };
  CHECK_NEAR(energy(end) / energy(begin), 1, 1e-3);
}

TEST(a_flight_ends_before_a_point_touches_what_comes_or_turns) {
  for (const double up : {0.0, 3.0})
    for (const double turns : {0.0, 4.0}) {
      Ringing r(0.3);
      Plane& plane = r.drive.planes[0];
      plane.velocity = Vec3(0, 0, up);
      plane.angular_velocity = Vec3(0, turns, 0);
      ModalFlight flight(r.lattice);
      CHECK(flight.possible(r.model.body));
      flight.enter(r.equations(), 0, r.run.physical.motion);
      const double free = flight.until_touch(r.equations(), 2, 1e-6, false);
      CHECK(free > 0.01 && free < 1.5);
      const Plane coming = plane;  // and the flights without it
      double least = 1;
      for (int i = 1; i <= 200; ++i) {
        const double t = free * i / 200;
        const State state = r.flown(t);
        for (int p = 0; p < r.lattice.points(); ++p) least = std::min(least, coming.at(t).gap(row(state.x, p)));
      }
      CHECK(least >= 0 && least < 0.02);
    }
}

TEST(a_body_too_large_for_modes_flies_as_a_rigid_one) {
  const StiffBox box{.stiffness = 1e6, .counts = {7, 6, 6}};
  SoftBody body = box.start();
  CHECK(3 * body.lattice().points() > Modes::most_unknowns);
  CHECK(run_for(body, 0.25, 0.05));
  CHECK(body.readings().method() == Method::floating_frame);
  CHECK_NEAR(body.state().x.col(2).mean(), 1 - 0.5 * 9.81 * 0.25 * 0.25, 1e-12);
}
