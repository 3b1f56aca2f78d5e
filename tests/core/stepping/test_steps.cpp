/// Runs of internal steps of every explicit method, on a lattice that vibrates: a newcomer joins the list.
#include "check.hpp"
#include "model/arithmetic.hpp"
#include "stepping/controlled_steps.hpp"
#include "stepping/fixed_steps.hpp"
#include "stepping/limits.hpp"
#include "stepping/propagator.hpp"

using namespace softffd;

namespace {

constexpr Method fixed[] = {Method::central_difference, Method::leapfrog, Method::bm4};
constexpr Method controlled[] = {Method::rkn12, Method::dop853, Method::ros34pw2};

struct Bench {
  Lattice lattice{{3, 3, 3}};
  Model model{body(lattice)};
  Drive drive;
  Request request{.tolerance = 1e-6};
  Run run;
  Integrators integrators{lattice, 0, 0};

  Bench() {
    const int n = lattice.points();
    model.body.springs.set_stiffness({100, 100, 100}, {});
    model.renew();
    for (Points* points : {&drive.force, &drive.force_rate, &drive.force_bend[0], &drive.force_bend[1]}) points->setZero(n, 3);
    State& motion = run.path.motion;
    motion.x = rest_positions(lattice);
    motion.x.col(0) *= 1.1;
    for (Points* points : {&motion.v, &motion.spring, &motion.previous, &run.course.bound_x, &run.course.factored.x}) points->setZero(n, 3);
    model.body.internal_force(motion.x, motion.spring);
  }
  static Body body(const Lattice& lattice) {
    const int n = lattice.points();
    return {.springs = Springs(lattice, Topology::distinct),
            .mass = Scalars::Constant(n, 1.0 / n),
            .damping = Scalars::Zero(n),
            .pinned = std::vector<bool>(n, false)};
  }
  Job job() { return {model, drive, request, run}; }
  double energy() const {
    const State& motion = run.path.motion;
    return model.body.elastic_energy(motion.x) + 0.5 * (model.body.mass * motion.v.square().rowwise().sum()).sum();
  }
};

/// Where 0.1 s of small given steps of the method of highest order lead.
Points reference() {
  Bench b;
  b.request.step = 1e-4;
  CHECK(run_counted(b.integrators, b.job(), Method::rkn12, 1000) == StepStatus::ok);
  return b.run.path.motion.x;
}

double difference(const Points& a, const Points& b) { return (a - b).abs().maxCoeff(); }

}  // namespace

TEST(given_steps_of_every_method_have_its_order) {
  const Points exact = reference();
  for (Method method : {Method::central_difference, Method::leapfrog, Method::bm4}) {
    std::vector<double> errors;
    for (Count steps : {50, 100}) {
      Bench b;
      b.request.step = 0.1 / double(steps);
      CHECK(run_counted(b.integrators, b.job(), method, steps) == StepStatus::ok);
      CHECK(b.run.path.steps == steps && b.run.path.clock.count == steps);
      errors.push_back(difference(b.run.path.motion.x, exact));
    }
    CHECK_NEAR(std::log2(errors[0] / errors[1]), double(traits(method).order), 0.15);
  }
}

TEST(fitted_steps_keep_the_tolerance_and_end_where_they_should) {
  const Points exact = reference();
  for (Method method : fixed) {
    Bench b;
    Calibrator calibrator(b.run);
    CHECK(run_fitted(b.integrators, calibrator, b.job(), method, 0.1, INFINITY) == StepStatus::ok);
    CHECK(b.run.path.motion.time == 0.1);
    CHECK(difference(b.run.path.motion.x, exact) < 5e-6);
    CHECK(b.run.course.work > 0);
  }
}

TEST(controlled_steps_keep_the_tolerance_and_end_where_they_should) {
  const Points exact = reference();
  for (Method method : controlled) {
    Bench b;
    CHECK(run_controlled(b.integrators, b.job(), method, 0.1, INFINITY) == StepStatus::ok);
    CHECK(b.run.path.motion.time == 0.1 && b.run.path.steps > 1);
    CHECK(difference(b.run.path.motion.x, exact) < 5e-6);
    CHECK(b.run.course.controlled_step(method) > 0);
  }
}

TEST(a_pause_comes_after_the_work_is_spent) {
  for (Method method : controlled) {
    Bench b;
    CHECK(run_controlled(b.integrators, b.job(), method, 0.1, 30) == StepStatus::ok);
    CHECK(b.run.path.motion.time > 0 && b.run.path.motion.time < 0.1 && b.run.course.work >= 30);
  }
}

TEST(a_calibration_takes_its_trial_back) {
  Bench b;
  Calibrator calibrator(b.run);
  const Points x = b.run.path.motion.x;
  CHECK(calibrator.due(b.job(), Method::leapfrog, 0.1, false));
  CHECK(calibrator.calibrate(b.integrators, b.job(), Method::leapfrog, 0.1, 4) > 0);
  CHECK((b.run.path.motion.x == x).all() && b.run.path.steps == 0 && b.run.path.motion.time == 0);
  CHECK(!calibrator.due(b.job(), Method::leapfrog, 0.1, false));
  CHECK(b.run.course.calibration(Method::leapfrog).h > 0);
}

TEST(a_race_finds_a_method_and_leaves_the_body_where_it_was) {
  Bench b;
  b.request.tolerance = 1e-9;
  Calibrator calibrator(b.run);
  Race race(b.run);
  const Points x = b.run.path.motion.x;
  CHECK(Race::due(b.job(), 0.1));
  race.run(b.integrators, calibrator, b.job(), 0.1);
  CHECK((b.run.path.motion.x == x).all() && b.run.path.motion.time == 0);
  CHECK(b.run.course.race.winner == Method::rkn12 && b.run.course.race.reason == Reason::least_work);
  CHECK(!Race::due(b.job(), 0.1));
}

TEST(limits_follow_the_methods_rows) {
  Bench b;
  const double h = step_limit(b.job(), Method::leapfrog, false), omega = bound(b.job());
  CHECK_NEAR(h * omega / 2, traits(Method::leapfrog).automatic, 1e-14);
  CHECK_NEAR(step_limit(b.job(), Method::bm4, true) * omega / 2, traits(Method::bm4).given, 1e-14);
  b.request.step_factor = 0.5;
  CHECK_NEAR(step_limit(b.job(), Method::leapfrog, false), h / 2, 1e-14 * h);
  b.request.step_factor = 1;
  b.request.horizon = 1e9;
  CHECK_NEAR(step_limit(b.job(), Method::rkn12, false) * omega / 2, 0.56 * traits(Method::rkn12).automatic, 1e-14);
}

TEST(a_new_version_of_the_material_is_met_by_every_method) {
  for (Method method : {Method::leapfrog, Method::bm4, Method::rkn12, Method::dop853, Method::ros34pw2}) {
    Bench one, other;
    const Span span{0, 0, 1e-3, 5};
    one.integrators.take(one.job(), method, span);
    for (Bench* b : {&one, &other}) {
      b->model.body.mass *= 3;
      b->model.body.damping.setConstant(0.2);
      b->model.renew();
      b->run = Bench().run;
      b->integrators.take(b->job(), method, span);
    }
    CHECK((one.run.path.motion.x == other.run.path.motion.x).all());
  }
}

TEST(the_propagator_ends_every_communication_step_on_time) {
  for (Method method : {Method::automatic, Method::leapfrog, Method::bm4, Method::rkn12, Method::dop853, Method::ros34pw2}) {
    Bench b;
    b.request.method = method;
    Propagator propagator(b.lattice, b.run);
    for (int i = 1; i <= 3; ++i) {
      const double end = b.run.path.motion.time + 0.03;
      CHECK(propagator.advance(b.job(), 0.03) == StepStatus::ok);
      CHECK(b.run.path.motion.time == end);
    }
  }
}
