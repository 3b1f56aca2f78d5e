#include "falling_box.hpp"

using namespace softffd;

TEST(a_box_of_any_stiffness_comes_to_rest_and_presses_with_its_weight) {
  for (double k : {1e5, 1e7, 1e9, 1e12})
    for (double h : {1e-3, 1e-2, 1e-1}) {
      FallingBox scene(k, 1);
      scene.damp(0.1);
      scene.around.planes[0].friction = 0.4;
      scene.state.x.col(2) += 0.001;
      CheckedRun runner(scene, h, 200 * h);
      CHECK_NEAR(-runner.force(0, h).z(), g, 1e-6);
      CHECK(std::abs(runner.force(0, h).x()) + std::abs(runner.force(0, h).y()) < 1e-6);
    }
}

TEST(the_incline_holds_below_the_angle_of_friction_and_lets_slide_above_on_narrow_lattices_and_wide_ones) {
  for (const int side : {4, 9})
    for (double k : side > 4 ? std::vector{1e5, 1e9} : std::vector{1e5, 1e9, 1e12})
      for (double degrees : {20.0, 25.0}) {
        const double time = side > 4 ? 0.2 : 1;
        FallingBox scene(k, 1, {{side, side, side}});
        const double exact = scene.incline(degrees);
        CheckedRun runner(scene, 0.01, time);
        CHECK_NEAR(FallingBox::mean(scene.state.v).x() / time, exact, 1e-3);
        if (degrees < 22) CHECK(FallingBox::mean(scene.state.x).x() - 0.5 < 1e-5);
        CHECK(runner.method.halvings() == 0);
      }
}

TEST(a_squeezed_box_pushes_back_in_proportion_to_its_stiffness) {
  std::vector<double> force;
  for (double k : {1e5, 1e9}) {
    FallingBox scene(k, 2);
    for (Plane& plane : scene.around.planes) plane.friction = 0.4;
    scene.around.planes[1].point = {0, 0, 1};
    scene.around.planes[1].normal = {0, 0, -1};
    scene.around.planes[1].velocity = {0, 0, -0.1};
    CheckedRun runner(scene, 0.02, 1);
    force.push_back(-runner.force(0, 0.02).z());
    CHECK_NEAR(-runner.force(0, 0.02).z() - runner.force(1, 0.02).z(), g, 1e-4);  // it still moves
    CHECK(runner.method.halvings() == 0);
  }
  CHECK_NEAR(force[1] / force[0], 1e4, 2);  // not exactly: the weight does not scale
  CHECK_NEAR(force[0], 122190, 200);        // explicit steps, as measured: 122200 N
}

TEST(a_point_rests_in_a_corner_of_three_planes_on_all_of_them) {
  const Vec3 normals[3] = {{1, 0.1, 0.4}, {-0.5, 0.8, 0.5}, {-0.4, -0.7, 0.3}};
  for (double mu : {0.0, 0.3}) {
    FallingBox scene(1e8, 3);
    for (int q = 0; q < 3; ++q) {
      Plane& plane = scene.around.planes[q];
      plane.normal = normals[q].normalized();
      plane.friction = mu;
      double least = 1e9;
      for (int p = 0; p < 64; ++p) least = std::min(least, plane.normal.dot(row(scene.state.x, p)));
      plane.point = (least - 0.01) * plane.normal;
    }
    scene.damp(0.2);
    CheckedRun runner(scene, 0.01, 3);
    Vec3 sum = Vec3::Zero();
    for (int q = 0; q < 3; ++q) {
      CHECK(-runner.force(q, 0.01).dot(scene.around.planes[q].normal) > 0.1);
      sum += runner.force(q, 0.01);
    }
    CHECK_NEAR((sum - Vec3(0, 0, -g)).norm(), 0.0, 1e-4);
  }
}

TEST(an_acute_wedge_holds_a_box_by_its_edge) {
  FallingBox scene(1e7, 2);
  scene.turn({0, 0.78539816339744831, 0});  // an edge of the box down
  for (int q = 0; q < 2; ++q) {
    scene.around.planes[q].normal = Vec3(q == 0 ? 1 : -1, 0, 0.3).normalized();
    scene.around.planes[q].point = {0.5, 0, -2};
    scene.around.planes[q].friction = 0.1;
  }
  scene.damp(0.1);
  CheckedRun runner(scene, 0.01, 3);
  CHECK_NEAR((runner.force(0, 0.01) + runner.force(1, 0.01)).z(), -g, 1e-3);
}

TEST(one_point_in_a_corner_is_held_by_what_the_planes_can_give) {
  // Lattice of eight points without springs: every point is a problem of its own with a known answer.
  FallingBox scene(0, 3, Lattice{{2, 2, 2}});
  scene.around.planes[0].normal = {1, 0, 0};
  scene.around.planes[1].normal = {0, 1, 0};
  scene.around.planes[2].normal = {0, 0, 1};
  scene.around.force.col(0) = Scalars::Constant(8, -1);
  scene.around.force.col(1) = Scalars::Constant(8, -2);
  scene.around.force.col(2) = Scalars::Constant(8, -3);
  CheckedRun runner(scene);
  CHECK(runner.step(scene, 0.01));
  const Vec3 expected[3] = {{-4, 0, 0}, {0, -8, 0}, {0, 0, -12}};  // four points on each plane
  for (int q = 0; q < 3; ++q) CHECK_NEAR((runner.force(q, 0.01) - expected[q]).norm(), 0.0, 1e-12);
  CHECK((row(scene.state.x, 0) == Vec3::Zero()) && (row(scene.state.v, 0) == Vec3::Zero()));
}

TEST(planes_that_leave_no_room_are_refused_and_so_is_a_pin_behind_one) {
  FallingBox scene(1e6, 2);
  scene.around.planes[1].point = {0, 0, 1};
  scene.around.planes[1].normal = {0, 0, -1};
  scene.around.planes[1].velocity = {0, 0, -20};
  CheckedRun runner(scene);
  scene.body.internal_force(scene.state.x, scene.state.spring);
  CHECK(runner.method.advance({scene.body, scene.around}, 0, 0.1, true, scene.state, runner.exchange) == StepStatus::impossible_planes);

  FallingBox held(1e6, 1);
  held.pin_layer(0);
  held.around.planes[0].velocity = {0, 0, 1};
  CheckedRun other(held);
  CHECK(other.method.advance({held.body, held.around}, 0, 0.01, true, held.state, other.exchange) == StepStatus::pin_behind_plane);
}

TEST(a_body_hangs_from_its_pin_with_its_weight_and_follows_it) {
  for (double k : {1e4, 1e9}) {
    FallingBox scene(k, 1);
    scene.around.planes[0].point = {0, 0, -1};
    scene.damp(1);
    scene.pin_layer(3);
    CheckedRun runner(scene, 0.01, 3);
    CHECK_NEAR(runner.exchange.pins[0].force.z() / 0.01, -g, 1e-6);
    scene.around.pins[0].since = runner.time;
    scene.around.pins[0].velocity = {0.3, 0, 0};
    scene.around.pins[0].angular_velocity = {0, 0, 0.5};
    if (!runner.run(scene, 0.01, 0.2)) return;  // the balances hold with the pin's impulse and work
  }
}

TEST(a_plane_that_lifts_the_box_does_the_work_of_lifting) {
  FallingBox scene(1e9, 1);
  scene.around.planes[0].friction = 0.5;
  scene.around.planes[0].velocity = {0.1, 0, 0.2};
  CheckedRun runner(scene, 0.01, 0.5);
  CHECK_NEAR(runner.exchange.work, g * 0.2 * 0.01, 1e-9);
  CHECK_NEAR(runner.loss, 0.0, 1e-12);
  CHECK_NEAR((FallingBox::mean(scene.state.v) - Vec3(0.1, 0, 0.2)).norm(), 0.0, 1e-9);
}

TEST(a_turning_table_carries_the_box_along) {
  FallingBox scene(1e9, 1);
  scene.around.planes[0].friction = 0.5;
  scene.around.planes[0].point = {0.5, 0.5, 0};
  scene.around.planes[0].angular_velocity = {0, 0, 0.5};
  scene.throw_at(Vec3::Zero(), {0, 0, 0.5});
  CheckedRun runner(scene, 0.01, 1);
  const Vec3 corner = rotated(Vec3(0, 0, 0.5), Vec3(-0.5, -0.5, 0)) + Vec3(0.5, 0.5, 0);
  CHECK_NEAR((row(scene.state.x, 0) - corner).norm(), 0.0, 1e-5);
}

/// A plane that rises from rest, faster and faster, with a stiff box on it: its way times the force on it.
TEST(a_plane_that_speeds_up_works_with_its_speed_halfway_through_the_step) {
  FallingBox scene(1e9, 1);
  scene.around.planes[0].acceleration = {0, 0, 3};
  CheckedRun runner(scene);
  const double h = 0.01;
  for (int i = 0; i < 20; ++i) {
    if (!runner.step(scene, h)) return;
    const double way = 0.5 * 3 * h * h * (2 * i + 1);
    CHECK_NEAR(runner.exchange.work, -runner.force(0, h).z() * way, 1e-12);
  }
  CHECK_NEAR(FallingBox::mean(scene.state.v).z(), 3 * 20 * h, 3 * h);
}
