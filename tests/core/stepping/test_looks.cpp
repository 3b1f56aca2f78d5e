/// When a run looks again at what it has learnt: at a body that has deformed, at forces that have jumped.
#include "bench.hpp"
#include "check.hpp"
#include "kit/limits.hpp"
#include "soft_bodies.hpp"
#include "stepping/controlled_steps.hpp"
#include "stepping/fixed_steps.hpp"

using namespace softffd;

namespace {

/// A soft body that flies apart: within a second it doubles.
struct Bursting : Bench {
  Bursting() {
    springs_of(model.body).set_stiffness({1, 1, 1}, {});
    model.renew();
    run.physical.motion.x = rest_positions(lattice);
    run.physical.motion.v = 3 * run.physical.motion.x;
    run.physical.motion.spring.setZero();
  }
  static double side(const Points& x) { return x.col(0).maxCoeff() - x.col(0).minCoeff(); }
  /// By which the edges have become longer since the bound was computed, relative to their rest length.
  double since_bound() const { return side(run.physical.motion.x) - side(*run.control.bound_x); }
};

/// Whether leapfrog's step is calibrated anew when the forces jump by this fraction, before that is due.
bool calibrates_after(double jump) {
  Definition definition = one_kilogram();
  definition.stretch = {1.1, 1, 1};
  SoftBody body = soft_body(definition, 1e3);
  body.settings.method = Method::leapfrog;
  body.settings.tolerance = 1e-5;
  const double H = 1e-3;
  const auto pull = [&](double force) { body.settings.force.change()(0, 0) = -(body.settings.force.change()(63, 0) = force); };
  pull(10);
  CHECK(body.initialize(0) == StepStatus::ok);
  const auto known = [&] { return body.run().control.calibrations[std::size_t(Method::leapfrog)]; };
  for (int k = 0; k < 3; ++k) CHECK(body.advance(H) == StepStatus::ok);
  CHECK(body.run().control.work < known().due);
  const double due = known().due;
  pull(10 * (1 + jump));
  CHECK(body.advance(H) == StepStatus::ok);
  return known().due != due;
}

}  // namespace

TEST(the_bound_is_that_of_a_state_whose_edges_differ_by_no_more_than_a_fifth) {
  for (double stretch : {1.15, 1.25, 1.9}) {
    Bench b;
    b.run.physical.motion.x = rest_positions(b.lattice);
    const double before = bound(b.context());
    CHECK(!deformed_since_bound(b.context()));
    b.run.physical.motion.x.col(0) *= stretch;
    const double fresh = b.model.stability.frequency(b.model.body, b.run.physical.motion.x);
    CHECK(fresh != before);
    CHECK(bound(b.context()) == (stretch > 1.2 ? fresh : before));
  }
}

TEST(runs_of_any_length_renew_the_bound_of_a_body_that_deforms) {
  const double h = 0.01;
  for (Method method : {Method::leapfrog, Method::bm4}) {
    Bursting given, fitted;
    given.request.step = fitted.request.step = h;
    Calibrator calibrator(fitted.run);
    CHECK(run_counted(given.integrators, given.context(), method, 100) == StepStatus::ok);
    CHECK(run_fitted(fitted.integrators, calibrator, fitted.context(), method, 1, INFINITY) == StepStatus::ok);
    for (const Bursting* b : {&given, &fitted}) {
      CHECK(Bursting::side(b->run.physical.motion.x) > 1.5);
      CHECK(b->since_bound() < 0.2 + 8 * 3 * h);
    }
  }
  Bursting controlled;
  controlled.request.tolerance = 1e-12;
  CHECK(run_controlled(controlled.integrators, controlled.context(), Method::dop853, 1, INFINITY) == StepStatus::ok);
  CHECK(Bursting::side(controlled.run.physical.motion.x) > 1.5);
  CHECK(controlled.since_bound() < 0.2 + 8 * 3 * h);
}

TEST(forces_that_set_off_larger_vibrations_make_a_calibration_due_at_once) {
  CHECK(!calibrates_after(0) && !calibrates_after(0.02));
  CHECK(calibrates_after(1000));
}
