#include "stepping/propagator.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "methods/traits.hpp"
#include "model/arithmetic.hpp"
#include "model/rigid_motion.hpp"

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
/// Explicit steps in a communication step above which contact is implicit, and the work of an implicit step in evaluations of the forces,
/// at least.
constexpr double stiff_contact = 200, implicit_contact_work = 150;
/// Work that an implicit step may take at least before explicit ones are tried: where a body buckles these are no shorter way.
constexpr double buckling_work = 1e6;
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
  course.contact = {};
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
  if (equations.around.planes.empty() || method == Method::central_difference) return advance_with(job, method, H);
  // Every given step decides for itself whether an obstacle is within reach, so that cutting the time changes nothing.
  const Count units = resolves_contact(method) ? 0 : counted_units(request, H);
  if (units == 0) return advance_near(job, method, H);
  const Reason reason = course.reason;
  for (Count left = units; left > 0; --left) {
    course.reason = reason;
    if (course.clock.unit == request.step && double(left) * double(course.clock.parts) > double(most_steps))
      return StepStatus::too_many_steps;
    const StepStatus status = advance_near(job, method, request.step);
    if (status != StepStatus::ok) return status;
  }
  return StepStatus::ok;
}

/// The given steps in a communication step, if they fit it without a rest and are not too many; else 0.
Count Propagator::counted_units(const Request& request, double H) {
  const double units = request.step > 0 ? std::round(H / request.step) : 0;
  return units >= 1 && units <= double(most_steps) && std::abs(H - units * request.step) <= 1e-9 * H ? Count(units) : 0;
}

/// A stretch of time in a scene with obstacles: those methods that do not know contact run where none is within reach.
StepStatus Propagator::advance_near(const Job& job, Method method, double H) {
  const auto& [equations, request, state, course, exchange] = job;
  const bool flies = method == Method::floating_frame && reach_.clear(equations.body, equations.around, state.time, state.x);
  if (!flies && reach_.may_touch(equations, state, H)) return advance_in_contact(job, method, H);
  if (method == Method::leapfrog) return advance_with(job, method, H);
  start_ = state;
  start_exchange_ = exchange;
  const Clock clock = course.clock;
  const Count steps = course.steps;
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
    const Count steps = job.course.steps;
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
  const Count steps = course.steps;
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
  const double unit = request.step, end = state.time + H;
  const bool automatic = asked == Method::automatic && unit == 0;
  if (asked == Method::automatic && unit > 0) course.reason = Reason::given_step;
  const Method method = asked == Method::automatic ? Method::leapfrog : asked;
  if (method != course.method) course.clock.unit = 0;  // how a given step is divided was for the other method
  course.method = method;
  if (const Count units = counted_units(request, H); units > 0) return run_counted(job, method, units);
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
  const Count steps = std::max(Count{1}, Count(std::llround(wanted)));
  course.clock = {begin, H / double(steps), 0};
  // Where it finds no way, a step may take as long as explicit steps would, which are tried with several sizes and cost more in contact.
  const double explicit_work = 8 * traits(Method::leapfrog).work * course.clock.h / step_limit(job, Method::leapfrog, false);
  const double most_work = std::min(std::max(explicit_work, buckling_work), double(most_steps));
  implicit_contact_->most_factorizations = Count(std::max(1.0, most_work / implicit_.factor));
  for (Count i = 0; i < steps; ++i) {
    const double next = i + 1 == steps ? end : course.clock.origin + double(i + 1) * course.clock.h;
    const Count made = implicit_contact_->factorizations();
    const StepStatus status = implicit_contact_->advance(equations, state.time, next - state.time, request.watch, state, exchange);
    course.work += std::max(implicit_contact_work, double(implicit_contact_->factorizations() - made) * implicit_.factor);
    if (status != StepStatus::ok) return status;
    state.time = next;
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
  const double step = 2 / stability_.frequency(body, x);
  return step > 0 ? std::min(step, std::numeric_limits<double>::max()) : 0;
}

}  // namespace softffd
