#include "instance/instance.hpp"

#include "messages/trouble.hpp"

namespace softffd::fmi {

namespace {

/// Returns the scene with a team of threads, if the lattice has enough points. Run and error estimate share the team, as they take turns.
SceneFile with_team(SceneFile scene) {
  const int threads = SpringPass::threads_of_use(scene.definition.lattice, scene.threads);
  if (threads > 1) scene.definition.team = std::make_shared<Team>(threads);
  return scene;
}

}  // namespace

Instance::Instance(SceneFile scene, Logger log, Standard standard)
    : logger(std::move(log)),
      scene_(with_team(std::move(scene))),
      body_(scene_.definition),
      variables_(scene_, body_.settings, standard),
      messages_(scene_, logger) {
  if (scene_.error_estimate) error_estimate_.emplace(scene_.definition);
  reset();
}

void Instance::reset() {
  phase = instantiated;
  times_ = {};
  messages_.reset();
  variables_.reset();
}

void Instance::setup_experiment(double start_time, double tolerance, double stop_time) {
  times_ = {.start = start_time, .now = start_time, .stop = stop_time, .tolerance = tolerance, .given = true};
}

void Instance::enter_initialization() {
  if (!times_.given) messages_.not_set_up();
  choose_tolerance();
  phase = initializing;
  variables_.touch();
}

/// Hosts may pass on the tolerance of DefaultExperiment, which is the scene's, without being asked to: it leaves a parameter that was set.
void Instance::choose_tolerance() {
  const double asked = times_.tolerance, set = variables_.tolerance();
  if (!(asked > 0) || asked == set) return;
  const bool wins = set == scene_.tolerance || asked != scene_.tolerance;
  if (set != scene_.tolerance) messages_.two_tolerances(set, asked, wins);
  if (wins) variables_.set_tolerance(asked);
}

void Instance::exit_initialization() {
  ensure_initial_state();
  phase = stepping;
  messages_.begun(body_, times_.now);
}

void Instance::apply_values() {
  variables_.apply(body_.settings);
  body_.settings.horizon = times_.horizon(scene_.stop_time);
}

void Instance::get(Type type, const fmi2ValueReference* references, std::size_t count, double* values) {
  ensure_initial_state();
  variables_.get(type, references, count, values, body_, estimate());
}

void Instance::ensure_initial_state() {
  if (phase != initializing || !variables_.changed()) return;
  apply_values();
  const StepStatus status = body_.initialize(0);  // the clock of the body starts at 0, because rounding of times grows with their size
  if (status != StepStatus::ok) {
    variables_.touch();
    throw CallError("the initial state: " + trouble(status, scene_, body_, times_.start, 0));
  }
  if (error_estimate_) error_estimate_->initialize(body_, 0);
}

fmi2Status Instance::do_step(double time, double step) {
  times_.check_step(time, step);
  variables_.begin_step(body_, estimate());
  if (variables_.changed()) apply_values();
  const StepStatus status = body_.advance(step);
  if (status == StepStatus::too_much_work || status == StepStatus::not_finite) {
    phase = step_failed;
    logger.log(fmi2Discard, log_discard, trouble(status, scene_, body_, times_.now, step));
    return fmi2Discard;
  }
  if (status != StepStatus::ok) throw CallError(trouble(status, scene_, body_, times_.now, step));
  if (error_estimate_) error_estimate_->follow(body_, step);
  times_.now = time + step;
  variables_.end_step(step);
  variables_.forget_rates();
  messages_.stepped(body_, times_.now, step, error_estimate_ ? error_estimate_->value() : 0);
  return fmi2OK;
}

}  // namespace softffd::fmi
