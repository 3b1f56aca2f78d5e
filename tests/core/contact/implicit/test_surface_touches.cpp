#include <algorithm>

#include "falling_box.hpp"
#include "icosphere.hpp"

using namespace softffd;

namespace {

/// A box with m x m samples on each of its six faces.
std::shared_ptr<const Samples> faces(const Lattice& lattice, int m) {
  std::vector<Vec3> places;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side)
      for (int j = 0; j < m; ++j)
        for (int i = 0; i < m; ++i) {
          Vec3 part = Vec3::Zero();
          part[axis] = side;
          part[(axis + 1) % 3] = i / double(m - 1);
          part[(axis + 2) % 3] = j / double(m - 1);
          const Vec3 place = lattice.origin + part.cwiseProduct(lattice.size);
          if (std::find(places.begin(), places.end(), place) == places.end()) places.push_back(place);
        }
  return std::make_shared<const Samples>(Basis::bezier, lattice, places);
}

FallingBox cube(double k, int planes, int samples = 4) {
  FallingBox scene(k, planes);
  scene.body.samples = faces(scene.lattice, samples);
  return scene;
}

FallingBox sphere(double k, int planes, int level = 3) {
  FallingBox scene(k, planes);
  scene.body.samples = std::make_shared<const Samples>(Basis::bezier, Lattice{}, icosphere(level, 0.4, {0.5, 0.5, 0.5}));
  return scene;
}

/// Released above the ground beside a plane, in a groove of this full angle in degrees.
FallingBox in_groove(double k, double degrees) {
  FallingBox scene = sphere(k, 2);
  const double half = degrees / 2 * M_PI / 180;
  scene.around.planes[0].normal = {std::cos(half), 0, std::sin(half)};
  scene.around.planes[1].normal = {-std::cos(half), 0, std::sin(half)};
  scene.state.x.col(0) -= 0.5;
  scene.state.x.col(1) -= 0.5;
  scene.state.x.col(2) += 0.4 / std::sin(half) + 0.05 - 0.5;
  return scene;
}

/// A body between the ground and a lid that comes down, moves aside and turns.
FallingBox pressed(FallingBox scene, double below) {
  scene.around.planes[0].point = {0, 0, below};
  Plane& lid = scene.around.planes[1];
  lid.point = {0.5, 0.5, 1 - below};
  lid.normal = {0, 0, -1};
  lid.velocity = {0.1, 0, -0.2};
  lid.angular_velocity = {0.1, 0.05, 0.5};
  for (Plane& plane : scene.around.planes) plane.friction = 0.4;
  scene.damp(0.1);
  return scene;
}

}  // namespace

TEST(a_cube_on_its_samples_presses_with_its_weight) {
  for (const auto [mu, k] : check::some(5, check::each_with<double, double>({0.0, 0.4}, {1e5, 1e7, 1e9}))) {
    FallingBox scene = cube(k, 1);
    scene.damp(0.02);
    scene.around.planes[0].friction = mu;
    CheckedRun runner(scene, 0.01, 3);
    CHECK_NEAR(-runner.force(0, 0.01).z(), g, 1e-12 * g);
    CHECK(scene.least_gap(runner.time) >= -1e-12);
    CHECK(runner.method.halvings() == 0 && runner.method.iterations() < 330);
  }
}

TEST(a_sphere_on_its_samples_comes_to_rest) {
  for (const auto [mu, k] : check::some(5, check::each_with<double, double>({0.0, 0.4}, {1e5, 1e7, 1e9}))) {
    FallingBox scene = sphere(k, 1);
    scene.damp(0.3);
    scene.around.planes[0].friction = mu;
    scene.state.x.col(2) -= scene.least_gap(0);
    CheckedRun runner(scene, 0.01, 6);
    CHECK_NEAR(-runner.force(0, 0.01).z(), g, 1e-11);
    CHECK(scene.state.v.abs().maxCoeff() < 1e-10);
    CHECK(runner.method.halvings() == 0);
  }
}

TEST(samples_stick_below_the_angle_of_friction_and_do_not_creep) {
  for (const auto [k, m] : check::some(3, check::each_with<double, int>({1e5, 1e9}, {4, 8}))) {
    FallingBox scene = cube(k, 1, m);
    scene.incline(20);
    CheckedRun runner(scene, 0.01, 1);
    const Points settled = scene.state.x;
    if (!runner.run(scene, 0.01, 4)) return;
    CHECK((scene.state.x - settled).abs().maxCoeff() < 1e-12);
  }
}

TEST(samples_slide_above_it_with_the_right_acceleration) {
  for (const double degrees : {25.0, 35.0})
    for (const double k : check::some<double>(2, {1e5, 1e7, 1e9})) {
      FallingBox scene = cube(k, 1, 8);
      const double exact = scene.incline(degrees);
      CheckedRun runner(scene, 0.01, 2);
      CHECK_NEAR(FallingBox::mean(scene.state.v).x(), 2 * exact, 1e-5);  // what the shear of the first steps leaves of a soft body
    }
}

TEST(a_sphere_in_a_groove_presses_both_sides_as_statics_have_it) {
  for (const auto [degrees, k] : check::some(5, check::each_with<double, double>({90.0, 60.0, 30.0}, {1e5, 1e9}))) {
    FallingBox scene = in_groove(k, degrees);
    scene.damp(0.5);
    CheckedRun runner(scene, 0.02, 20);
    const double exact = 0.5 * g / std::sin(degrees / 2 * M_PI / 180);
    for (int q = 0; q < 2; ++q) CHECK_NEAR(runner.force(q, 0.02).norm(), exact, 1e-5);
  }
}

TEST(what_lands_tumbles_and_rolls_loses_energy_alone_and_keeps_to_the_balances) {
  for (const auto [mu, k] : check::some(5, check::each_with<double, double>({0.0, 0.4, 1.0}, {1e5, 1e9}))) {
    FallingBox scene = cube(k, 1, 5);
    scene.around.planes[0].friction = mu;
    scene.turn({0.5, 0, 0});
    scene.turn({0, 0.3, 0});
    scene.state.x.col(2) -= scene.least_gap(0) - 0.02;
    scene.throw_at({1, 0, 0}, {0, 2, 0});
    CheckedRun runner(scene);
    for (int i = 0; i < 150; ++i) {
      if (!runner.step(scene, 0.01)) return;
      const Vec3 force = -runner.force(0, 0.01);
      CHECK(force.head<2>().norm() <= mu * force.z() * (1 + 1e-9) + 1e-9);
      CHECK(runner.loss > -1e-3);  // off an edge backward Euler gains a little, as with control points
    }
  }
}

TEST(a_lid_that_comes_down_and_turns_presses_what_holds_it) {
  for (const auto [k, round] : check::some(3, check::each_with<double, bool>({1e5, 1e7}, {true, false}))) {
    FallingBox scene = pressed(round ? sphere(k, 2) : cube(k, 2), round ? 0.1 : 0);
    CheckedRun runner(scene, 0.01, 0.2);
    const Vec3 sum = runner.force(0, 0.01) + runner.force(1, 0.01);
    CHECK(runner.force(1, 0.01).z() > 0.02 * k);
    CHECK(sum.norm() < 1e-2 * runner.force(1, 0.01).norm());
  }
}

TEST(what_is_pinned_is_pressed_by_its_samples) {
  for (const double k : {1e5, 1e9}) {
    FallingBox scene = sphere(k, 1);
    scene.pin_layer(3);
    scene.around.planes[0].point = {0, 0, 0.1};
    scene.around.planes[0].velocity = {0.1, 0, 0.1};
    scene.around.planes[0].friction = 0.4;
    scene.damp(0.1);
    CheckedRun runner(scene, 0.01, 0.3);
    CHECK(-runner.force(0, 0.01).z() > 0.1 * k);
  }
}

TEST(obstacles_that_leave_no_room_are_refused) {
  FallingBox scene = cube(1e5, 2);
  scene.around.planes[1].point = {0, 0, -0.1};
  scene.around.planes[1].normal = {0, 0, -1};
  ImplicitContact method(scene.lattice, 2, 0, scene.body.samples.get());
  Exchange exchange;
  exchange.planes.resize(2);
  CHECK(method.advance({scene.body, scene.around}, 0, 0.01, false, scene.state, exchange) == StepStatus::impossible_planes);

  FallingBox held = cube(1e5, 1);
  held.pin_layer(0);
  held.around.planes[0].point = {0, 0, 0.1};
  ImplicitContact other(held.lattice, 1, 0, held.body.samples.get());
  exchange.pins.resize(1);
  CHECK(other.advance({held.body, held.around}, 0, 0.01, false, held.state, exchange) == StepStatus::pin_behind_plane);
}

TEST(steps_with_samples_converge_to_the_explicit_ones_with_first_order) {
  FallingBox scene = cube(1e3, 1);
  scene.damp(0.5);
  scene.around.planes[0].friction = 0.3;
  scene.throw_at({0.5, 0, 0}, Vec3::Zero());
  check_convergence_to_explicit_contact(scene);
}

TEST(internal_damping_and_volume_stiffness_are_in_the_matrix_as_with_control_points) {
  for (const double k : {1e5, 1e9}) {
    FallingBox scene = sphere(k, 1);
    springs_of(scene.body).set_dashpots(1e-3);
    scene.body.energies.push_back(std::make_shared<Volume>(scene.lattice, k));
    scene.around.planes[0].friction = 0.4;
    scene.damp(0.3);
    scene.state.x.col(2) -= scene.least_gap(0);
    CheckedRun runner(scene, 0.01, 6);
    CHECK_NEAR(-runner.force(0, 0.01).z(), g, 1e-10);
  }
}

TEST(the_state_has_all_that_the_next_step_begins_with) {
  FallingBox scene = sphere(1e7, 1);
  scene.around.planes[0].friction = 0.4;
  scene.turn({0.2, 0.1, 0});
  scene.state.x.col(2) -= scene.least_gap(0) - 0.001;
  scene.throw_at({1, 0, 0}, {0, 1, 0});
  scene.body.internal_force(scene.state.x, scene.state.spring);
  check_nothing_is_kept(scene);
}

TEST(samples_of_weight_one_meet_planes_as_control_points_do) {
  for (const bool sdirk2 : {false, true})
    for (const double k : {1e4, 1e7}) {
      FallingBox points(k, 1);
      points.incline(25);  // it slides
      springs_of(points.body).set_dashpots(1e-3);
      points.turn({0, 0.05, 0});
      points.state.x.col(2) -= points.state.x.col(2).minCoeff();
      FallingBox samples = points;
      samples.body.samples = std::make_shared<Samples>(samples.lattice);
      CheckedRun(points, 0.005, 0.5, sdirk2);
      CheckedRun(samples, 0.005, 0.5, sdirk2);
      CHECK_NEAR((samples.state.x - points.state.x).abs().maxCoeff(), 0.0, 1e-6);
      CHECK(points.state.x.col(0).minCoeff() > 0.02);
    }
}

TEST(steps_at_rest_keep_their_matrix_and_another_instance_goes_on_with_the_same_bits) {
  FallingBox scene = cube(1e5, 1);
  scene.damp(0.3);
  scene.around.planes[0].friction = 0.4;
  CheckedRun runner(scene, 0.01, 6);
  const Samples* samples = scene.body.samples.get();
  const Equations equations{scene.body, scene.around};
  ImplicitContact one(scene.lattice, 1, 0, samples), other(scene.lattice, 1, 0, samples), anew(scene.lattice, 1, 0, samples);
  Factored kept, copy;
  kept.x.change().setZero(scene.lattice.points(), 3);
  one.keep(kept);
  State state = scene.state;
  Exchange exchange = runner.exchange;
  const auto step = [&](ImplicitContact& method, State& from, double t) {
    CHECK(method.advance(equations, t, 0.01, false, from, exchange) == StepStatus::ok);
  };
  for (int i = 0; i < 3; ++i) step(one, state, runner.time + 0.01 * i);
  CHECK(one.factorizations() == 1);
  State beside = state, fresh = state;
  copy = kept;
  other.keep(copy);
  step(one, state, runner.time + 0.03);
  step(other, beside, runner.time + 0.03);
  step(anew, fresh, runner.time + 0.03);
  CHECK(one.factorizations() == 1 && other.factorizations() == 0);
  CHECK((state.x == beside.x).all() && (state.v == beside.v).all());
  CHECK((state.x - fresh.x).abs().maxCoeff() < 1e-10);
}
