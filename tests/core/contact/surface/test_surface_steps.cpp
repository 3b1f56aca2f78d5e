#include "surface_bodies.hpp"

using namespace softffd;

namespace {

Vec3 angular_momentum(const SoftBody& body) {
  Vec3 sum = Vec3::Zero();
  for (int p = 0; p < 64; ++p) sum += row(body.state().x, p).cross(row(body.state().v, p)) / 64;
  return sum;
}

}  // namespace

TEST(impulses_on_the_planes_are_what_the_body_loses) {
  SoftBody body = tumbling(1e-3, 2);
  body.settings.gravity.setZero();
  body.settings.planes[1].angular_velocity.setZero();
  body.initialize(0);
  double touched = 0;
  for (int i = 0; i < 300; ++i) {
    const Vec3 momentum = body.state().v.colwise().mean().matrix().transpose(), angular = angular_momentum(body);
    CHECK(body.advance(0.01) == StepStatus::ok);
    const Vec3 now = body.state().v.colwise().mean().matrix().transpose();
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
    for (int q = 0; q < 2; ++q) {
      const Vec3 on = body.readings().plane_reaction(q);
      force += on;
      const Vec3 point = body.settings.planes[q].point + body.state().time * body.settings.planes[q].velocity;
      torque += body.readings().plane_torque(q) + point.cross(on);
    }
    touched += force.norm();
    CHECK((now - momentum + 0.01 * force).norm() < 1e-13);
    if (body.settings.planes[1].velocity.isZero(0)) CHECK((angular_momentum(body) - angular + 0.01 * torque).norm() < 1e-13);
  }
  CHECK(touched > 1);
}

TEST(energy_is_kept_but_for_what_is_booked) {
  std::vector<double> errors;
  for (const double h : {4e-4, 2e-4}) {
    const Sphere sphere{.level = 2, .height = 0.02, .damping = 0, .friction = 0.5, .velocity = {1, 0, -1}, .planes = 2};
    Definition definition = sphere.definition();
    definition.watch_energy = true;
    SoftBody body = sphere.body(definition);
    body.settings.step = h;
    body.settings.planes[1] = {{1.2, 0, 0}, {-1, 0, 0.1}, {-0.5, 0, 0}, {0, 0.2, 0}, 0.3, false};
    body.initialize(0);
    const auto energy = [&] {
      const Readings now = body.readings();
      return now.kinetic_energy() + now.elastic_energy() + now.gravity_energy() + body.run().dissipated - body.run().work;
    };
    const double begin = energy();
    double worst = 0;
    for (int i = 0; i < 50; ++i) {
      CHECK(body.advance(0.01) == StepStatus::ok);
      worst = std::max(worst, std::abs(energy() - begin));
    }
    errors.push_back(worst);
    CHECK(body.run().dissipated > 0.1);
  }
  CHECK(errors[1] < 0.02 && errors[0] > 2.5 * errors[1]);
}

TEST(cutting_changes_no_bit_in_contact_of_the_surface) {
  std::vector<Points> ends;
  for (const int parts : {1, 2, 5}) {
    SoftBody body = tumbling(1e-3, 2, 0.02);
    body.initialize(0.7);
    go(body, 20 * parts, 0.05 / parts);
    ends.push_back(body.state().x);
  }
  CHECK((ends[0] == ends[1]).all());
  CHECK((ends[0] == ends[2]).all());
}

TEST(what_is_pinned_stays_and_the_rest_gives_way) {
  const Sphere sphere{.level = 3, .height = 0.02, .damping = 0.5};
  const Samples samples = sphere.samples();
  Definition definition = sphere.definition();
  definition.pins.emplace_back();
  for (int p = 48; p < 64; ++p) definition.pins[0].points.push_back(p);
  SoftBody body = sphere.body(definition);
  body.settings.gravity.setZero();
  body.settings.step = 1e-3;
  body.settings.pins[0].position = Vec3(0.5, 0.5, 1) + definition.offset;
  body.settings.planes[0] = {{0, 0, 0}, {0, 0, 1}, {0, 0, 0.05}, Vec3::Zero(), 0.4, false};
  CHECK(body.initialize(0) == StepStatus::ok);
  double force = 0;
  for (int i = 0; i < 200; ++i) {
    CHECK(body.advance(0.01) == StepStatus::ok);
    CHECK(lowest(samples, body) >= body.state().time * 0.05 - 1e-12);
    CHECK_NEAR(body.state().x(63, 2), 0.92, 1e-15);
    force = -body.readings().plane_reaction(0).z();
  }
  CHECK(force > 100);
  CHECK_NEAR(body.readings().pin_reaction(0).z(), force, 0.02 * force);
}

TEST(automatic_steps_follow_landings_by_the_tolerance_and_state_their_error) {
  int followed = 0, all = 0;
  for (const int throws : check::some<int>(2, {0, 1, 2, 3, 4, 5})) {
    const auto landed = [throws](double h, double tolerance) {
      const Sphere sphere{.level = 2, .height = 0.1, .damping = 0, .friction = 0, .velocity = {1, 0.3, -1 - 0.05 * throws}, .planes = 1};
      SoftBody body = sphere.body(Vec3(0.4 + 0.3 * throws, 3, 0.7));
      body.settings.step = h;
      body.settings.horizon = 0.15;
      body.settings.tolerance = tolerance;
      CHECK(body.initialize(0) == StepStatus::ok);
      go(body, 15, 0.01);
      return body;
    };
    const SoftBody fine = landed(2e-6, 1e-4);
    for (const double tolerance : {1e-3, 3e-4, 1e-4, 3e-5}) {
      const SoftBody body = landed(0, tolerance);
      const double error = distance(fine.state().x, body.state().x), stated = body.readings().stated_error();
      CHECK(body.readings().method() == Method::leapfrog && body.readings().reason() == Reason::contact);
      CHECK(error < 3 * stated && stated < 10 * std::max(error, tolerance));
      followed += error < 3 * tolerance;
      ++all;
    }
  }
  CHECK(followed > 0.9 * all);  // which facet strikes first may hang on less
}

TEST(a_stiff_body_with_samples_falls_by_its_modes_and_rests_in_implicit_steps) {
  for (const double stiffness : check::some<double>(2, {1e6, 1e5})) {
    const Sphere sphere{.level = 1, .height = 0.02, .stiffness = stiffness, .friction = 0};
    SoftBody fine = sphere.body(), body = sphere.body();
    fine.settings.method = Method::leapfrog;
    fine.settings.step = 4e-6;
    body.settings.horizon = 0.5;
    for (SoftBody* each : {&fine, &body}) {
      CHECK(each->initialize(0) == StepStatus::ok);
      go(*each, 25, 0.02);
    }
    CHECK(distance(fine.state().x, body.state().x) < 1e-4);  // the tolerance
    go(body, 125, 0.02);
    CHECK(body.readings().method() == Method::backward_euler);
    CHECK_NEAR(body.readings().plane_reaction(0).z(), -9.81, 1e-9);
    CHECK(lowest(sphere.samples(), body) >= -1e-12);
  }
}

TEST(forces_of_faces_in_a_corner_are_in_the_work_of_a_call_and_end_it) {
  const auto in_corner = [](double most_work) {
    SoftBody body = cube(3, 2e3, 4);
    body.settings.planes[0] = {.point = {0.05, 0, 0}, .normal = Vec3::UnitX(), .friction = 0.4};
    body.settings.planes[1] = {.point = {0, 0.05, 0}, .normal = Vec3::UnitY(), .friction = 0.4};
    body.settings.planes[2].friction = 0.4;
    body.settings.gravity = {-3, -4, -9.81};
    body.settings.step = 1e-3;
    body.settings.most_work = most_work;
    body.initialize(0);
    return body;
  };
  SoftBody body = in_corner(1e6), other = in_corner(2'000);
  CHECK(body.advance(0.1) == StepStatus::ok);
  CHECK(body.work_done() > 50 * 100);  // 100 steps, which are one each without contact
  CHECK(other.advance(0.1) == StepStatus::too_much_work);
  CHECK(other.work_done() < 1.3 * 2'000);
}
