#include "falling_box.hpp"

using namespace softffd;

namespace {

/// A soft body thrown into a corner.
FallingBox crumpling(int n) {
  FallingBox scene(2, 3, n % 2 ? Lattice{{2, 3, 5}} : Lattice{});
  scene.around.planes[0].friction = 0.8;
  scene.around.planes[1].normal = {-1, 0, 0};
  scene.around.planes[1].point = {1.2, 0, 0};
  scene.around.planes[2].normal = Vec3(0.2, 1, 0.1).normalized();
  scene.around.planes[2].point = {0, -0.5, 0};
  scene.turn({0.1 * n, 0.3, 0.2});
  scene.state.x.col(2) -= scene.state.x.col(2).minCoeff();
  scene.state.x.col(0) -= scene.state.x.col(0).maxCoeff() - 1.1;
  scene.state.x.col(1) += 1;
  scene.throw_at({2, -2, -3}, {3, 5, -2});
  return scene;
}

/// Most energy that a step gains while a box tumbles. Backward Euler gains some where the box falls off the edge it balances on: there
/// the energy along the motion is concave, and the step's error is of second order.
double tumbling_gain(double k, double h, double& lost) {
  FallingBox scene(k, 1);
  scene.around.planes[0].friction = 0.4;
  scene.turn({0.5, 0, 0});
  scene.turn({0, 0.3, 0});
  scene.state.x.col(2) += 0.02 - scene.state.x.col(2).minCoeff();
  scene.throw_at({1, 0, 0}, {0, 2, 0});
  CheckedRun runner(scene);
  double gain = 0;
  lost = 0;
  for (int i = 0; i < std::lround(1.5 / h); ++i) {
    if (!runner.step(scene, h)) break;
    gain = std::max(gain, -runner.loss);
    lost += runner.loss;
  }
  CHECK(runner.method.halvings() == 0);
  return gain;
}

}  // namespace

TEST(a_tumbling_box_loses_energy_in_its_impacts) {
  for (double k : {1e5, 1e9, 1e12}) {
    double lost = 0;
    CHECK(tumbling_gain(k, 0.01, lost) < 1e-4);
    CHECK(lost > 1);
  }
  double lost = 0;
  const double coarse = tumbling_gain(1e9, 0.01, lost), fine = tumbling_gain(1e9, 0.005, lost);
  CHECK(fine < 0.4 * coarse);
}

TEST(without_planes_it_is_backward_euler) {
  FallingBox falling(1e6, 0);
  falling.damp(0.3);
  CheckedRun runner(falling);
  double v = 0, z = 0;
  for (int i = 0; i < 20; ++i) {
    if (!runner.step(falling, 0.05)) return;
    v = (v - 0.05 * g) / (1 + 0.05 * 0.3 * 64);
    z += 0.05 * v;
  }
  CHECK_NEAR(FallingBox::mean(falling.state.v).z(), v, 1e-12);
  CHECK_NEAR(falling.state.x(0, 2), z, 1e-12);

  FallingBox spinning(1e12, 0);
  spinning.around.force.setZero();
  spinning.throw_at(Vec3::Zero(), {0, 0, 2});
  CheckedRun spin(spinning);
  CHECK(spin.step(spinning, 0.1));  // tan of the angle is 0.2
  const Vec3 arm = row(spinning.state.x, 0) - Vec3(0.5, 0.5, 0);
  CHECK_NEAR(std::atan2(-arm.x(), -arm.y()), 3.14159265358979 / 4 - std::atan(0.2), 1e-9);
}

TEST(a_step_that_is_too_long_is_done_in_parts) {
  Count halvings = 0;
  for (int n = 0; n < 6; ++n) {
    FallingBox scene = crumpling(n);
    CheckedRun runner(scene, 0.1, 1);
    halvings += runner.method.halvings();
  }
  CHECK(halvings > 0);
}

TEST(a_step_that_finds_no_way_gives_up_after_so_many_matrices) {
  FallingBox scene = crumpling(0);
  CheckedRun runner(scene);
  runner.method.most_factorizations = 20;
  scene.body.internal_force(scene.state.x, scene.state.spring);
  const Equations equations{scene.body, scene.around};
  StepStatus status = StepStatus::ok;
  for (int i = 0; i < 10 && status == StepStatus::ok; ++i) {
    const Count made = runner.method.factorizations();
    status = runner.method.advance(equations, 0.1 * i, 0.1, false, scene.state, runner.exchange);
    CHECK(runner.method.factorizations() - made <= 20 + 14);  // the last solution may change its touches
  }
  CHECK(status == StepStatus::not_finite);
}

TEST(nothing_is_kept_between_steps) {
  FallingBox scene(1e7, 1);
  scene.around.planes[0].friction = 0.4;
  scene.turn({0.2, 0.1, 0});
  scene.state.x.col(2) += 0.001 - scene.state.x.col(2).minCoeff();
  scene.throw_at({1, 0, 0}, {0, 1, 0});
  scene.body.internal_force(scene.state.x, scene.state.spring);
  check_nothing_is_kept(scene);
}

TEST(what_sticks_stays_where_it_is_in_steps_of_any_length) {
  for (const double k : check::some<double>(2, {1e4, 1e5, 1e9}))
    for (const double h : {1e-3, 0.01, 0.1}) {
      FallingBox scene(k, 1);
      scene.damp(0.5);
      scene.incline(21);
      scene.body.internal_force(scene.state.x, scene.state.spring);
      ImplicitContact method(scene.lattice, 1, 0);
      Exchange exchange;
      exchange.planes.resize(1);
      Points settled;
      const int steps = int(std::lround(4 / h));
      double resting = 0;
      for (int i = 0; i < steps; ++i) {
        if (i == steps / 2) settled = scene.state.x;
        CHECK(method.advance({scene.body, scene.around}, i * h, h, false, scene.state, exchange) == StepStatus::ok);
        resting = std::max(resting, i < steps / 2 ? 0.0 : (scene.state.x - settled).abs().maxCoeff());
      }
      CHECK(resting < 1e-12);
      CHECK(scene.state.holds[0].abs().maxCoeff() > 0.1 * g * std::sin(21 * M_PI / 180) / 16);
    }
}

TEST(it_converges_to_the_explicit_contact_with_first_order_and_so_with_internal_damping) {
  for (const double dashpots : check::some<double>(2, {0.003, 0.0})) {
    FallingBox scene(1e3, 1);
    scene.damp(0.5);
    springs_of(scene.body).set_dashpots(dashpots);
    scene.around.planes[0].friction = 0.3;
    scene.state.x.col(2) += 0.01;
    scene.throw_at({0.5, 0, 0}, Vec3::Zero());
    check_convergence_to_explicit_contact(scene);
  }
}
