#include "propagator.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "rigid_motion.hpp"
#include "traits.hpp"

namespace softffd {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
/// Spring vectors may change by this share of the shortest edge before the bound is computed anew.
constexpr double deformation_limit = 0.2;
/// The same with a volume stiffness, which grows fast once a corner begins to fold.
constexpr double deformation_limit_with_volume = 0.05;
/// Vibrations in radians from which on a run is long: near its stability limit rkn12 takes a millionth of a vibration's energy a step.
constexpr double long_run = 1e5;
/// (omega h) (spin h) that an implicit step may have; angle by which the body may turn in a step in its own frame.
constexpr double largest_turn = 1e-4, largest_turn_in_frame = 1;
/// Internal steps between two looks at the deformation.
constexpr long look_every = 8;
/// Explicit steps in a communication step above which contact is implicit, and the work of an implicit step in evaluations of the forces.
constexpr double stiff_contact = 200, implicit_contact_work = 150;
/// Explicit steps in an implicit one above which the masses are lost in the rounding of the stiffness matrix.
constexpr double stiffest = 2e7;

}  // namespace

Propagator::Propagator(const Lattice& lattice, int planes, int pins)
    : stability_(lattice.points()),
      leapfrog_(lattice.points(), planes),
      central_difference_(lattice.points()),
      bm4_(lattice.points(), pins),
      rkn12_(lattice.points(), pins),
      dop853_(lattice.points(), pins),
      implicit_(lattice),
      reach_(lattice.points()),
      time_scale_(3 * lattice.points()),
      memory_(3 * lattice.points()),
      x0_(lattice.points(), 3),
      v0_(lattice.points(), 3) {
  if (LayerMatrix::fits(lattice)) {
    ros34pw2_.emplace(lattice, pins);
    floating_frame_.emplace(lattice, *ros34pw2_);
    implicit_contact_.emplace(lattice, planes);
  }
  const int points = lattice.points();
  start_exchange_.planes.resize(planes);
  start_exchange_.pins.resize(pins);
  scratch_ = start_exchange_;
  for (State* state : {&start_, &coarse_, &fine_})
    for (Points* values : {&state->x, &state->v, &state->spring, &state->previous}) values->setZero(points, 3);
  trial_course_.bound_x.setZero(points, 3);
  trial_course_.factored.x.setZero(points, 3);
}

void Propagator::body_changed(const Body& body, Course& course) {
  stability_.prepare(body);
  leapfrog_.body_changed();
  bm4_.body_changed();
  fastest_damping_ = body.damping_rate.maxCoeff();
  for (int i = 0; i < memory_.size(); ++i) memory_[i] = body.damping_rate[i] > 0 ? 2 / body.damping_rate[i] : infinity;
  stability_.time_scales(body, time_scale_);
  rkn12_.time_scale = dop853_.time_scale = time_scale_;
  if (ros34pw2_) {
    ros34pw2_->time_scale = time_scale_;
    ros34pw2_->body_changed();
    implicit_contact_->body_changed();
  }
  course.bound = -1;
  course.leapfrog = course.bm4 = {};
  course.factored.h = 0;
  course.favourite = Method::automatic;
}

StepStatus Propagator::advance(const Equations& equations, const Request& request, double H, State& state, Course& course,
                               Exchange& exchange) {
  const Job job{equations, request, state, course, exchange};
  Method method = request.method;
  assert(ros34pw2_ || !needs_matrices(method));
  course.reason = Reason::asked;
  course.usual = std::max(H, 0.8 * course.usual);
  if (method == Method::rkn12 && equations.body.damped) method = Method::dop853, course.reason = Reason::damping;
  if (method == Method::backward_euler) return run_implicit(job, state.time + H);
  const bool resolves_contact = method == Method::leapfrog || method == Method::central_difference;
  if (equations.around.planes.empty() || method == Method::central_difference) return advance_with(job, method, H);
  if (reach_.may_touch(equations, state, H)) return advance_in_contact(job, method, H);
  if (resolves_contact) return advance_with(job, method, H);
  start_ = state;
  start_exchange_ = exchange;
  const Clock clock = course.clock;
  const long steps = course.steps;
  const StepStatus status = advance_with(job, method, H);
  if (status != StepStatus::contact_ahead) return status;
  state = start_;
  exchange = start_exchange_;
  course.clock = clock;
  course.rejected += course.steps - steps;
  course.steps = steps;
  return advance_in_contact(job, method, H);
}

StepStatus Propagator::advance_in_contact(const Job& job, Method asked, double H) {
  const bool implicit = implicit_contact_ && (asked == Method::automatic || is_implicit(asked));
  const double stiffness = H / step_limit(job, Method::leapfrog, false);
  if (implicit && job.request.step == 0 && stiffness > stiff_contact && stiffness < stiffest) {
    start_ = job.state;
    start_exchange_ = job.exchange;
    if (asked != Method::ros34pw2 && fly_on(job, H)) return StepStatus::ok;
    job.course.reason = Reason::stiff_contact;
    const long steps = job.course.steps;
    const StepStatus status = run_implicit(job, job.state.time + H);
    if (status != StepStatus::not_finite) return status;
    job.course.rejected += job.course.steps + 1 - steps;
    job.course.steps = steps;
    job.state = start_;
    job.exchange = start_exchange_;
  }
  if (asked != Method::leapfrog) job.course.reason = Reason::contact;
  if (job.request.step > 0) return advance_with(job, Method::leapfrog, H);
  job.course.method = Method::leapfrog;
  return run_doubled(job, job.state.time + H);
}

/// A stiff body within reach of an obstacle, but not on it, flies on if that does not end behind one: first-order steps would take its
/// spin.
bool Propagator::fly_on(const Job& job, double H) {
  const auto& [equations, request, state, course, exchange] = job;
  if (!equations.around.pins.empty() || !reach_.clear(equations.body, equations.around, state.time, state.x)) return false;
  const long steps = course.steps;
  const double end = state.time + H;
  course.method = Method::floating_frame;
  course.reason = Reason::free_flight;
  const StepStatus status = run_controlled(job, course.method, end, course.work + implicit_contact_work);
  if (status == StepStatus::ok && state.time == end) return true;
  course.rejected += course.steps - steps;
  course.steps = steps;
  state = start_;
  exchange = start_exchange_;
  return false;
}

StepStatus Propagator::advance_with(const Job& job, Method asked, double H) {
  const auto& [equations, request, state, course, exchange] = job;
  const double unit = request.step, units = unit > 0 ? std::round(H / unit) : 0, end = state.time + H;
  const bool automatic = asked == Method::automatic && unit == 0;
  if (asked == Method::automatic && unit > 0) course.reason = Reason::given_step;
  course.method = asked == Method::automatic ? Method::leapfrog : asked;
  if (units >= 1 && units <= double(most_steps) && std::abs(H - units * unit) <= 1e-9 * H)
    return run_counted(job, course.method, long(units));
  const double begun = course.work;
  while (state.time < end) {
    if (automatic) choose(job, end - state.time);
    if (state.time == end) break;  // a trial took it there
    if (automatic && course.work - begun + course.forecast > 1.2 * double(most_steps)) return StepStatus::too_many_steps;
    // A winner that needs far more than it seemed to runs again.
    const double pause_at = automatic ? std::min(course.race_due, course.work + 2.5 * course.forecast + 100) : infinity;
    const bool controlled = traits(course.method).error_control() && unit == 0;
    const StepStatus status =
        controlled ? run_controlled(job, course.method, end, pause_at) : run_fitted(job, course.method, end, pause_at);
    if (status != StepStatus::ok) return status;
    if (state.time < end) course.race_due = course.work;
  }
  return StepStatus::ok;
}

StepStatus Propagator::run_implicit(const Job& job, double end) {
  const auto& [equations, request, state, course, exchange] = job;
  const double begin = state.time, H = end - begin;
  course.method = Method::backward_euler;
  const double wanted = (request.step > 0 ? H / request.step : 1) / request.share;
  if (!(wanted <= double(most_steps) / implicit_contact_work)) return refusal(wanted);
  const long steps = std::max(1L, std::lround(wanted));
  course.clock = {begin, H / double(steps), 0};
  for (long i = 0; i < steps; ++i) {
    const double next = i + 1 == steps ? end : course.clock.origin + double(i + 1) * course.clock.h;
    const StepStatus status = implicit_contact_->advance(equations, state.time, next - state.time, request.watch, state, exchange);
    if (status != StepStatus::ok) return status;
    state.time = next;
    course.work += implicit_contact_work;
    ++course.steps;
  }
  return StepStatus::ok;
}

double Propagator::bound(const Job& job) {
  Course& course = job.course;
  if (course.bound < 0 || deformed_since_bound(job)) {
    course.bound = stability_.frequency(job.equations.body, job.state.x);
    course.bound_x = job.state.x;
  }
  return course.bound;
}

double Propagator::step_limit(const Job& job, Method method, bool given) {
  double limit = infinity;
  const Traits t = traits(method);
  if (stability_.elastic()) limit = (given ? t.given : t.automatic) * 2 / bound(job);
  if (method == Method::rkn12 && !given && job.request.horizon * bound(job) > long_run) limit *= 0.56;
  if (method == Method::bm4) limit = std::min(limit, 10 / fastest_damping_);
  if (method == Method::dop853) limit = std::min(limit, 5 / fastest_damping_);
  if (method == Method::ros34pw2 && !given) limit = std::min(limit, turning_limit(job, job.state.x, job.state.v));
  if (method == Method::floating_frame && !given)
    limit = std::min(stiffest / bound(job),
                     largest_turn_in_frame / rigid_motion(job.equations.body.mass, job.state.x, job.state.v).spin.norm());
  return limit * job.request.share;
}

/// Longest implicit step of a turning body. A step takes points along straight lines; what that stretches the springs throws them back with
/// (omega h) times the speed of turning, so that the energy of the rotation errs by about (omega h spin h)^2. Where pins turn, the
/// forces on them do.
double Propagator::turning_limit(const Job& job, const Points& x, const Points& v) {
  double spin = rigid_motion(job.equations.body.mass, x, v).spin.norm();
  for (const Pin& pin : job.equations.around.pins) spin = std::max(spin, pin.at(job.state.time).spin.norm());
  return std::min({stiffest / bound(job), std::sqrt(largest_turn / (bound(job) * spin)), 0.005 / spin});
}

bool Propagator::deformed_since_bound(const Job& job) const {
  const Body& body = job.equations.body;
  for (const Springs::Row& row : body.springs.rows()) {
    if (row.direction.kind() != SpringKind::edge) break;
    kernels::SpringRow edges = row.view();
    if (body.volume) edges.stiffness = row.multiplicity.data();  // edges without stiffness count too
    const double limit = (body.volume ? deformation_limit_with_volume : deformation_limit) * row.rest_length[0];
    const double change =
        kernels::largest_change(edges, body.points(), job.state.x.data(), job.course.bound_x.data(), body.springs.scratch());
    if (change > limit * limit) return true;
  }
  return false;
}

StepStatus Propagator::run_counted(const Job& job, Method method, long units) {
  Clock& clock = job.course.clock;
  const double unit = job.request.step;
  while (units > 0) {
    // Looks are counted too, so that they fall on the same moments however the time is cut.
    if (clock.unit != unit || job.course.bound < 0 || clock.count / clock.parts % look_every == 0 || job.request.share < 1) {
      const double limit = std::min(unit * job.request.share, step_limit(job, method, true));
      if (!(unit / limit <= double(most_steps))) return refusal(unit / limit);
      const long parts = divisions(unit, limit);
      if (clock.unit != unit || clock.parts != parts) clock = {job.state.time, unit / double(parts), 0, unit, parts};
    }
    if (double(units) * double(clock.parts) > double(most_steps)) return StepStatus::too_many_steps;
    const long ahead = std::min(units, look_every - clock.count / clock.parts % look_every);
    const StepStatus status = run_stretch(job, method, clock.h, ahead * clock.parts);
    if (status != StepStatus::ok) return status;
    job.state.time = clock.time();
    units -= ahead;
  }
  return StepStatus::ok;
}

StepStatus Propagator::run_fitted(const Job& job, Method method, double end, double pause_at) {
  const auto& [equations, request, state, course, exchange] = job;
  const bool given = request.step > 0;
  const bool stable_only = method == Method::central_difference && !equations.around.planes.empty();  // its contact does not converge
  Calibration& calibration = method == Method::bm4 ? course.bm4 : course.leapfrog;
  Clock& clock = course.clock;
  long steps = 0;
  while (true) {
    if (stable_only)
      calibration.h = infinity;
    else if (!given && calibration_due(job, calibration, end - state.time, request.jolt && steps == 0))
      calibrate(job, method, end - state.time, 4);
    const double limit = std::min(step_limit(job, method, given), request.share * (given ? request.step : calibration.h));
    if (steps == 0 || clock.h > limit || limit > 1.25 * clock.h) {
      const double left = end - state.time;
      if (!(left / limit <= double(most_steps))) return refusal(left / limit);
      steps = divisions(left, limit);
      clock = {state.time, left / double(steps), 0};
    }
    const long ahead = std::min(steps, look_every);
    const StepStatus status = run_stretch(job, method, clock.h, ahead);
    if (status != StepStatus::ok) return status;
    steps -= ahead;
    state.time = steps == 0 ? end : clock.time();
    if (steps == 0 || course.work >= pause_at) return StepStatus::ok;
  }
}

StepStatus Propagator::run_stretch(const Job& job, Method method, double h, long steps) {
  const Task task{job.course.clock.origin, job.course.clock.count, h, steps};
  job.course.clock.count += steps;
  job.course.steps += steps;
  job.course.work += double(steps) * traits(method).work;
  return take_steps(job, method, task, job.state, job.exchange);
}

StepStatus Propagator::take_steps(const Job& job, Method method, const Task& task, State& state, Exchange& exchange) {
  const Equations& equations = job.equations;
  const auto& [body, around] = equations;
  const bool watch = job.request.watch, planes = !around.planes.empty();
  if (method == Method::central_difference) return central_difference_.advance(body, around, task, watch, state, exchange);
  if (method == Method::leapfrog) return leapfrog_.advance(body, around, task, watch, state, exchange);
  for (long i = 0; i < task.steps; ++i) {
    const double t = task.time(i);
    if (planes) x0_ = state.x, v0_ = state.v;
    if (method == Method::bm4) {
      bm4_.step(equations, t, task.h, watch, state, exchange);
    } else {
      job.course.factored.h = 0;  // nobody looks at the error of a given step: an old factor could spoil it
      attempt({equations, job.request, state, job.course, exchange}, method, t, task.h);
      accept(controlled(method), equations, state, exchange);
    }
    if (planes && reach_.passed(around, t, t + task.h, x0_, v0_, state.x, state.v)) return StepStatus::contact_ahead;
  }
  return StepStatus::ok;
}

void Propagator::accept(OneStep& trial, const Equations& equations, State& state, Exchange& exchange) {
  state.x.swap(trial.x);
  state.v.swap(trial.v);
  equations.body.internal_force(state.x, state.spring);
  if (trial.ledger.recording()) trial.ledger.settle(exchange);
}

OneStep& Propagator::controlled(Method method) {
  if (method == Method::ros34pw2) return *ros34pw2_;
  if (method == Method::floating_frame) return *floating_frame_;
  return method == Method::rkn12 ? static_cast<OneStep&>(rkn12_) : dop853_;
}

/// Tries a step of a method with error control; returns its error [m].
double Propagator::attempt(const Job& job, Method method, double t, double h) {
  OneStep& trial = controlled(method);
  trial.ledger.open(job.equations, job.request.watch, method == Method::floating_frame);
  if (!is_implicit(method)) {
    job.course.work += traits(method).work;
    return trial.attempt(job.equations, t, h, job.state);
  }
  Factored& factored = ros34pw2_->factored = job.course.factored;
  const bool in_frame = method == Method::floating_frame;
  if (factored.in_frame != in_frame) factored.in_frame = in_frame, factored.h = 0;
  const double error = trial.attempt(job.equations, t, h, job.state);
  job.course.factored = factored;
  const bool made = job.course.factored.uses == 1;  // not whether it was made now: after a restore it is made again
  job.course.factors += made;
  job.course.work += implicit_.step + (made ? implicit_.factor : 0) + (in_frame ? implicit_.frame : 0);
  return error;
}

double& Propagator::controlled_step(Course& course, Method method) {
  if (method == Method::floating_frame) return course.floating_frame;
  return method == Method::rkn12 ? course.rkn12 : method == Method::dop853 ? course.dop853 : course.ros34pw2;
}

StepStatus Propagator::run_controlled(const Job& job, Method method, double end, double pause_at) {
  const auto& [equations, request, state, course, exchange] = job;
  OneStep& trial = controlled(method);
  double& h = controlled_step(course, method);
  const bool planes = !equations.around.planes.empty();
  const double forgets = std::min(request.horizon, memory_.maxCoeff());
  const double rounding = 1e-15 * std::max(equations.body.length, kernels::largest(state.x.size(), state.x.data()));
  const double tightened = request.tolerance * power(request.share, traits(method).order);
  const auto tolerance = [&, t = traits(method)](double step) {
    return std::max(rounding, std::min(t.largest_share, t.summed_share * step / forgets) * tightened);
  };
  const double least = 1e-14 * std::max(std::abs(end), end - state.time);
  double limit = step_limit(job, method, false);
  // In the frame the first step is as long as may be: short ones would follow the vibrations that it is to pass over.
  const bool short_first = stability_.elastic() && method != Method::floating_frame;
  if (!(h > 0)) h = request.share * std::min(end - state.time, short_first ? 3 / bound(job) : infinity);
  course.clock = {state.time, h, 0};
  const double begun = course.work;
  for (long tries = 1; state.time < end; ++tries) {
    if (course.work - begun > double(most_steps)) return StepStatus::too_many_steps;
    const double left = end - state.time;
    const long ahead = divisions(left, std::min(h, limit));  // equal parts, so that no sliver is left at the end
    const double step = ahead == 1 ? left : left / double(ahead);
    if (!(step > least)) return StepStatus::not_finite;
    const double error = attempt(job, method, state.time, step) / tolerance(step);
    const bool turned = method == Method::ros34pw2 && step > 2 * turning_limit(job, trial.x, trial.v);
    if (method == Method::ros34pw2) limit = step_limit(job, method, false);
    const double factor = turned ? 0.5 : error > 0 ? 0.9 * root(1 / error, trial.exponent, 0.1, 6) : error == 0 ? 5 : 0.1;
    if (!(error <= 1) || turned) {
      ++course.rejected;
      const bool old_factor = is_implicit(method) && course.factored.uses > 1;
      if (old_factor) course.factored.h = 0;
      h = step * (old_factor ? std::clamp(factor, 0.5, 0.95) : std::min(factor, 0.9));
      if (method == Method::floating_frame && course.work >= pause_at) return StepStatus::ok;
      continue;
    }
    // A step that the communication point has cut short says that it can be longer only as far as it was tried.
    const bool keep = is_implicit(method) && factor > 0.95 && factor < 1.5;  // and with the step the factor
    if (!keep && (factor * step > h || (factor < 5 && step > 0.2 * h))) h = step * factor;
    if (planes && passes(job, method, step, trial)) return StepStatus::contact_ahead;
    accept(trial, equations, state, exchange);
    ++course.steps;
    course.clock.h = step;
    state.time = ahead == 1 ? end : state.time + step;
    if (course.work >= pause_at) return StepStatus::ok;
    if (tries % look_every == 0 && deformed_since_bound(job)) limit = step_limit(job, method, false);
  }
  return StepStatus::ok;
}

/// Does the step tried go behind an obstacle? In the frame the end decides, as it does for the implicit contact step, which would take
/// over.
bool Propagator::passes(const Job& job, Method method, double step, const OneStep& trial) {
  const auto& [body, around] = job.equations;
  const double t = job.state.time;
  if (method == Method::floating_frame) return !reach_.clear(body, around, t + step, trial.x);
  return reach_.passed(around, t, t + step, job.state.x, job.state.v, trial.x, trial.v);
}

double Propagator::amplitude(const Body& body, double energy, double slowest) const {
  double total = 0, weighted = 0;
  for (int p = 0; p < body.points(); ++p) {
    const double time = std::min(slowest, time_scale_[p]);
    total += body.mass[p];
    weighted += body.mass[p] * time * time;
  }
  return std::sqrt(2 * energy * weighted) / total;
}

/// Leaves the bound of the course alone: looking must not change what follows.
double Propagator::stable_step(const Body& body, const Points& x) {
  if (!stability_.elastic()) return std::numeric_limits<double>::max();
  return std::min(2 / stability_.frequency(body, x), std::numeric_limits<double>::max());
}

}  // namespace softffd
