/// Runs of internal steps of every explicit method, on a lattice that vibrates: a newcomer joins the list.
#include "bench.hpp"
#include "check.hpp"
#include "kit/limits.hpp"
#include "stepping/controlled_steps.hpp"
#include "stepping/fixed_steps.hpp"
#include "stepping/propagator.hpp"

using namespace softffd;

namespace {

constexpr Method fixed_methods[] = {Method::central_difference, Method::leapfrog, Method::bm4};
constexpr Method controlled[] = {Method::rkn12, Method::dop853, Method::ros34pw2};

/// Where 0.1 s of small given steps of the method of highest order lead.
Points reference() {
  Bench b;
  b.request.step = 1e-4;
  CHECK(run_counted(b.integrators, b.context(), Method::rkn12, 1000) == StepStatus::ok);
  return b.run.physical.motion.x;
}

}  // namespace

TEST(fitted_and_controlled_steps_keep_the_tolerance_and_end_where_they_should) {
  const Points exact = reference();
  const auto keeps = [&](const Bench& b) {
    CHECK(b.run.physical.motion.time == 0.1 && b.run.physical.steps > 1 && b.run.control.work > 0);
    CHECK(distance(b.run.physical.motion.x, exact) < 5e-6);
  };
  for (Method method : fixed_methods) {
    Bench b;
    Calibrator calibrator(b.run);
    CHECK(run_fitted(b.integrators, calibrator, b.context(), method, 0.1, INFINITY) == StepStatus::ok);
    keeps(b);
  }
  for (Method method : controlled) {
    Bench b;
    CHECK(run_controlled(b.integrators, b.context(), method, 0.1, INFINITY) == StepStatus::ok);
    keeps(b);
    CHECK(b.run.control.controlled_step(method) > 0);
  }
}

TEST(a_step_is_kept_only_if_its_error_is_allowed) {
  for (Method method : controlled) {
    const Traits& t = traits(method);
    Bench probe;
    const double h = 0.5 * std::min(step_limit(probe.context(), method, false), 4 * step_limit(probe.context(), Method::leapfrog, false));
    const double error = probe.integrators.one_step(method).offer(probe.model, probe.drive, 0, h, probe.run).error;
    const double share = std::min(t.tolerance_step, t.tolerance_sum * h);  // of the tolerance, in a run of a second
    for (double ratio : {0.5, 2.0, 10.0}) {
      Bench b;
      b.request.tolerance = error / (ratio * share);
      b.run.control.controlled_step(method) = h;
      CHECK(run_controlled(b.integrators, b.context(), method, h, 0) == StepStatus::ok);
      CHECK(b.run.physical.steps == 1 && b.run.physical.clock.h == b.run.physical.motion.time);
      CHECK((b.run.control.rejected > 0) == (ratio > 1));
      CHECK((b.run.physical.clock.h < h) == (ratio > 1));
      Bench again;
      const double kept = b.run.physical.clock.h;
      const double err = again.integrators.one_step(method).offer(again.model, again.drive, 0, kept, again.run).error;
      CHECK(err <= std::min(t.tolerance_step, t.tolerance_sum * kept) * b.request.tolerance * (1 + 1e-6));
    }
  }
}

TEST(a_pause_comes_after_the_work_is_spent) {
  for (Method method : controlled) {
    Bench b;
    CHECK(run_controlled(b.integrators, b.context(), method, 0.1, 30) == StepStatus::ok);
    CHECK(b.run.physical.motion.time > 0 && b.run.physical.motion.time < 0.1 && b.run.control.work >= 30);
  }
}

TEST(a_calibration_takes_its_trial_back) {
  Bench b;
  Calibrator calibrator(b.run);
  const Points x = b.run.physical.motion.x;
  CHECK(calibrator.due(b.context(), Method::leapfrog, 0.1));
  CHECK(calibrator.calibrate(b.integrators, b.context(), Method::leapfrog, 0.1, 4) > 0);
  CHECK((b.run.physical.motion.x == x).all() && b.run.physical.steps == 0 && b.run.physical.motion.time == 0);
  CHECK(!calibrator.due(b.context(), Method::leapfrog, 0.1));
  CHECK(b.run.control.calibration(Method::leapfrog).h > 0);
}

TEST(a_race_finds_a_method_and_leaves_the_body_where_it_was) {
  Bench b;
  b.request.tolerance = 1e-9;
  Calibrator calibrator(b.run);
  TrialRuns trials(b.run);
  const Points x = b.run.physical.motion.x;
  CHECK(TrialRuns::due(b.context(), 0.1));
  trials.run(b.integrators, calibrator, b.context(), 0.1);
  CHECK((b.run.physical.motion.x == x).all() && b.run.physical.motion.time == 0);
  CHECK(b.run.control.trials.winner == Method::rkn12 && b.run.control.trials.reason == Reason::least_work);
  CHECK(!TrialRuns::due(b.context(), 0.1));
}

TEST(limits_follow_the_methods_rows) {
  Bench b;
  const double h = step_limit(b.context(), Method::leapfrog, false), omega = bound(b.context());
  CHECK_NEAR(h * omega / 2, traits(Method::leapfrog).automatic, 1e-14);
  CHECK_NEAR(step_limit(b.context(), Method::bm4, true) * omega / 2, traits(Method::bm4).given, 1e-14);
  b.request.step_factor = 0.5;
  CHECK_NEAR(step_limit(b.context(), Method::leapfrog, false), h / 2, 1e-14 * h);
  b.request.step_factor = 1;
  b.request.horizon = 1e9;
  CHECK_NEAR(step_limit(b.context(), Method::rkn12, false) * omega / 2, 0.56 * traits(Method::rkn12).automatic, 1e-14);
}

TEST(a_new_version_of_the_material_is_met_by_every_method) {
  for (Method method : {Method::leapfrog, Method::bm4, Method::rkn12, Method::dop853, Method::ros34pw2}) {
    Bench one, other;
    const Span span{0, 0, 1e-3, 5};
    one.integrators.take(one.context(), method, span);
    for (Bench* b : {&one, &other}) {
      b->model.body.mass *= 3;
      b->model.body.damping.setConstant(0.2);
      b->model.renew();
      b->run = Bench().run;
      b->integrators.take(b->context(), method, span);
    }
    CHECK((one.run.physical.motion.x == other.run.physical.motion.x).all());
  }
}

TEST(the_propagator_ends_every_communication_step_on_time) {
  for (Method method : {Method::automatic, Method::leapfrog, Method::bm4, Method::rkn12, Method::dop853, Method::ros34pw2}) {
    Bench b;
    b.request.method = method;
    Propagator propagator(b.lattice, 0, 0);
    for (int i = 1; i <= 3; ++i) {
      const double end = b.run.physical.motion.time + 0.03;
      CHECK(propagator.advance(b.context(), 0.03) == StepStatus::ok);
      CHECK(b.run.physical.motion.time == end);
    }
  }
}
