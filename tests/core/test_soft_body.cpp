#include "soft_bodies.hpp"

using namespace softffd;

namespace {

Definition stretched(int planes = 0, const std::array<int, 3>& counts = {4, 4, 4}) {
  Definition definition = one_kilogram(counts, planes);
  definition.stretch = {1.1, 1, 1};
  return definition;
}

/// A box of 1 kg at rest on the ground, with a followed point on its lower side.
SoftBody resting_box() {
  Definition definition = one_kilogram({4, 4, 4}, 1);
  definition.watch_energy = true;
  definition.sensed.followed.push_back({.at = {0.5, 0.5, 0}});
  SoftBody body = soft_body(definition, 2e3);
  body.settings.damping = 2;
  body.settings.gravity = {0, 0, -9.81};
  body.settings.planes[0] = {{0, 0, -0.05}, {0, 0, 1}, Vec3::Zero(), Vec3::Zero(), 0, false};
  body.initialize(0);
  go(body, 300, 0.01);
  return body;
}

}  // namespace

TEST(too_much_work_is_refused_at_once_and_larger_lattices_may_do_less_in_a_call) {
  SoftBody stiff = soft_body(stretched(), 1e15);
  stiff.initialize(0);
  CHECK(stiff.advance(1) == StepStatus::too_much_work && stiff.state().time == 0);
  for (const bool given : {false, true})
    for (const int planes : {0, 1}) {
      Definition definition = stretched(planes, {16, 16, 16});
      definition.offset = {0, 0, planes * 1e-3};
      SoftBody body = soft_body(definition, 1e5);
      if (planes > 0) body.settings.method = Method::leapfrog;  // an implicit step would end it
      body.initialize(0);
      const double h = 0.5 * body.readings().stable_step();
      if (given) body.settings.step = h;
      CHECK(body.advance(4 * h) == StepStatus::ok);
      CHECK(body.advance(100'000 * h) == StepStatus::too_much_work);  // a 64th of 5 million is 78,125
      CHECK(body.run().control.work < 4e3);                           // trial runs
    }
}

TEST(a_call_does_no_more_than_its_work) {
  const auto loads = check::each_with<double, double>({-10.0, -1e6}, {0.0, -1e60});  // of gravity [m/s2] and at a point [N]
  for (const Method method : {Method::automatic, Method::leapfrog, Method::dop853, Method::ros34pw2, Method::backward_euler})
    for (const auto& [stiffness, load] : check::some(3, check::each_with<double, std::pair<double, double>>({1e5, 1e8}, loads))) {
      SoftBody body = soft_body(stretched(1), stiffness);
      body.settings.method = method;
      body.settings.damping = 0.01;
      body.settings.gravity = {0, 0, load.first};
      body.settings.force.change()(5, 2) = load.second;
      body.settings.planes[0] = {{0, 0, -0.01}, {0, 0, 1}, {0, 0, 1}, Vec3::Zero(), 0.3, true};
      body.settings.most_work = 50'000;
      body.initialize(0);
      for (int i = 0; i < 2; ++i) {
        const StepStatus status = body.advance(0.1);
        CHECK(status == StepStatus::ok || status == StepStatus::too_much_work || status == StepStatus::not_finite);
        CHECK(body.work_done() > 0 && body.work_done() < 1.3 * body.settings.most_work);  // what has begun ends
      }
    }
}

TEST(reactions_are_the_mean_force_also_in_communication_steps_that_rounding_hides) {
  const auto shrinking = [](double by) {
    std::vector<double> steps;
    for (double H = 0.01; H > 1e-15; H /= by) steps.push_back(H);
    steps.push_back(0.01);
    return steps;
  };
  const auto alike = [](double first, double then) {
    std::vector<double> steps(1000, then);
    steps.front() = first;
    return steps;
  };
  for (const auto& steps : {shrinking(2), shrinking(10), alike(1e-8, 1e-9), alike(1e-8, 1e-10), alike(1e-5, 1e-9)})
    for (const double horizon : {1e-3, 60.0}) {
      SoftBody body = resting_box();
      body.settings.horizon = horizon;
      const double dissipated = body.readings().dissipated_energy();
      for (const double H : steps) {
        CHECK(body.advance(H) == StepStatus::ok);
        CHECK(std::abs(body.readings().plane_reaction(0).z() + 9.81) < 1e-3);
        CHECK((body.readings().plane_centre(0) - Vec3(0.5, 0.5, -0.05)).norm() < 1e-3);
        CHECK(body.readings().followed(0).acceleration.norm() < 1e-3);
        CHECK(std::abs(body.readings().dissipated_energy() - dissipated) < 1e-9);
      }
    }
}

TEST(a_pin_carries_the_weight_in_the_shortest_communication_steps_too) {
  Definition definition = one_kilogram();
  PinDefinition& pin = definition.pins.emplace_back();
  const Points rest = rest_positions(definition.lattice);
  for (int p = 0; p < rest.rows(); ++p)
    if (rest(p, 2) == rest.col(2).maxCoeff()) pin.points.push_back(p);
  SoftBody body = soft_body(definition, 2e3);
  body.settings.damping = 2;
  body.settings.gravity = {0, 0, -9.81};
  body.initialize(0);
  go(body, 300, 0.01);
  for (double H = 0.01; H > 1e-15; H /= 2) {
    CHECK(body.advance(H) == StepStatus::ok);
    CHECK(std::abs(body.readings().pin_reaction(0).z() + 9.81) < 2e-3);  // the clock rounds H by up to 1e-4 of it
  }
}

TEST(what_is_pushed_at_once_is_shown_at_once_however_short_the_communication_step) {
  SoftBody body = resting_box();
  for (const double H : {1e-10, 1e-10, 1e-10}) CHECK(body.advance(H) == StepStatus::ok);
  body.settings.planes[0].velocity = {0, 0, 1};
  CHECK(body.advance(1e-10) == StepStatus::ok);
  CHECK(-body.readings().plane_reaction(0).z() * 1e-10 > 0.9 * 16 / 64.0);  // 16 points of 1/64 kg
  body.settings.planes[0].velocity.setZero();
  CHECK(body.advance(1e-10) == StepStatus::ok);
  CHECK(body.readings().plane_reaction(0).norm() < 1e-6);
}

TEST(forces_whose_squares_are_no_numbers_are_refused_before_a_step) {
  SoftBody body = soft_body(stretched(1), 1e8);
  body.settings.planes[0] = {{0, 0, 0}, {0, 0, 1}, Vec3::Zero(), Vec3::Zero(), 0, false};
  body.settings.force.change()(0, 2) = -1e300;
  body.initialize(0);
  CHECK(body.advance(0.1) == StepStatus::not_finite);
  CHECK(body.work_done() == 0);
}

TEST(a_change_that_waits_at_a_refused_step_waits_on) {
  SoftBody body = soft_body(stretched(), 1e3);
  body.initialize(0);
  CHECK(body.advance(1e-3) == StepStatus::ok);
  body.settings.stiffness = {1e13, 1e13, 1e13};
  CHECK(body.advance(1e3) == StepStatus::too_much_work);
  CHECK(body.advance(1e-6) == StepStatus::ok);
  CHECK(body.readings().internal_step() < 2e-8);
  CHECK(body.state().x.abs().maxCoeff() < 2);
}

TEST(a_damped_body_under_a_load_that_grows_is_watched) {
  for (const Method method : check::some<Method>(2, {Method::leapfrog, Method::bm4, Method::ros34pw2, Method::dop853, Method::automatic})) {
    SoftBody body = soft_body(stretched(), 1e3);
    body.settings.damping = 0.02;
    body.settings.method = method;
    body.initialize(0);
    const double before = body.readings().elastic_energy();
    for (int i = 0; i < 100; ++i) {
      body.settings.force.change()(63, 0) = 20 * (i % 20) * 0.05;
      body.settings.force_rate.change()(63, 0) = 20 / 0.2;  // up to 20 N, and at once back
      CHECK(body.advance(0.01) == StepStatus::ok);
      CHECK(body.run().energy.kinetic_elastic >= 0);
      CHECK(!body.readings().gains_energy());
    }
    CHECK(body.run().energy.due > 0 && body.readings().largest_energy() >= before);
    CHECK(body.readings().dissipated_energy() == 0);  // nobody asks
  }
}

TEST(a_gain_of_a_damped_body_under_a_load_that_grows_is_seen) {
  SoftBody body = soft_body(stretched(), 1e3);
  body.settings.damping = 1e-6;
  body.settings.step = 1e-3;
  body.settings.force_rate.change()(63, 0) = 1e-6;
  body.initialize(0);
  go(body, 20, 0.1);
  CHECK(!body.readings().gains_energy());
  Run more = body.run();
  more.physical.motion.v *= 2;
  body.restore(more, 0);
  go(body, 20, 0.1);
  CHECK(body.readings().gains_energy());
}

TEST(a_scene_that_explicit_steps_suit_never_factors_a_matrix) {
  const auto factors = [](double k, double damping, Vec3 stretch, Vec3 spin, int planes, double H, int side = 4) {
    Definition definition = one_kilogram({side, side, side}, planes);
    definition.mass.assign(side * side * side, 1.0 / 64);
    definition.stretch = stretch;
    definition.angular_velocity = spin;
    definition.offset = {0, 0, 0.05};
    SoftBody body = soft_body(definition, k);
    body.settings.damping = damping;
    body.settings.gravity = {0, 0, -9.81};
    body.initialize(0);
    go(body, 10, H);
    return body.factorizations();
  };
  const Vec3 still = Vec3::Zero(), pulled(1.1, 1, 1), plain = Vec3::Ones();
  CHECK(factors(1e3, 0, pulled, still, 0, 0.1) == 0);                                 // vibrates
  CHECK(factors(1e3, 0.05, pulled, still, 0, 0.1) == 0);                              // the same, damped
  CHECK(factors(1e5, 0, plain, {0, 0, 20}, 0, 0.1) == 0);                             // turns
  CHECK(factors(2e3, 0.1, plain, {0, 1, 0}, 1, 0.01) == 0);                           // falls onto the ground
  CHECK(factors(1e7, 0.5, plain, still, 0, 0.1) > 0);                                 // stiff and quiet: here a matrix is worth it
  for (int side : {8, 9}) CHECK(factors(1e7, 0.5, plain, still, 0, 0.01, side) > 0);  // with a factor, and with conjugate gradients
}

TEST(a_damped_box_that_was_dropped_comes_to_rest) {
  const double seconds = 10, weight = 9.81;  // 20 times that in which damping of 0.5 N s/m forgets
  const auto moves_after = [&](std::array<int, 3> counts, double k, double H) {
    Definition definition = one_kilogram(counts, 1);
    definition.offset = {0, 0, 0.02};
    SoftBody body = soft_body(definition, k);
    body.settings.damping = 0.5;
    body.settings.gravity = {0, 0, -weight};
    body.settings.horizon = seconds;
    body.initialize(0);
    const int steps = int(std::lround(seconds / H));
    for (int i = 0; i < steps; ++i) {
      CHECK(body.advance(H) == StepStatus::ok);
      if (i < 0.9 * steps) continue;
      const double pressure = -body.readings().plane_reaction(0).z(), speed = body.state().v.abs().maxCoeff();
      if (std::abs(pressure / weight - 1) > 1e-4 || speed > 1e-5) return true;
    }
    return false;
  };
  for (const std::array<int, 3> counts : check::some<std::array<int, 3>>(2, {{2, 2, 2}, {2, 2, 3}, {3, 3, 3}, {2, 2, 4}}))
    for (const double k : check::some<double>(3, {1e2, 1e3, 1e4, 1e5}))
      for (const double H : check::some<double>(3, {1e-3, 2e-3, 3e-3, 7e-3, 8e-3, 1e-2, 1.5e-2, 3e-2})) {
        const bool moves = moves_after(counts, k, H);
        CHECK(!moves);
        if (moves) std::printf("  %d x %d x %d, k = %g N/m, H = %g s\n", counts[0], counts[1], counts[2], k, H);
      }
}
