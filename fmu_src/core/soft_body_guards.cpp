/// Guards of the soft body: which results of a communication step stand, which are tried again with smaller steps, and what is to be warned
/// of.
#include <algorithm>
#include <utility>

#include "model/rigid_motion.hpp"
#include "soft_body.hpp"

namespace softffd {

namespace {

/// Share of 2 / omega above which friction can feed the vibrations of an undamped body.
constexpr double rubbing_share = 0.3;
/// How often the internal step of a communication step without a finite result is halved.
constexpr int most_halvings = 5;
/// Work of all trials of a communication step together, in evaluations of the spring forces.
constexpr double trial_work = 5e6;
/// Smallest share of the usual internal step that a gain of energy leads to.
constexpr double least_share = 1.0 / 32;
/// Of the energy gained, what may be left with smaller steps if it was these that were at fault.
constexpr double mended_share = 0.25;
/// Displacement relative to the box by which a jump of points is small.
constexpr double small_jump = 1e-3;

}  // namespace

/// Where nothing moves at all, nothing is to be decided.
bool SoftBody::undecided() const {
  const State& motion = now_.motion;
  if (motion.spring.isZero(0)) return false;
  for (const Springs::Row& springs : body_.springs.rows())
    for (int lane = 0; lane < springs.lanes(); ++lane) {
      const int p = springs.begin + lane, q = p + springs.offset;
      const bool apart = row(motion.x, p) != row(motion.x, q) || row(motion.v, p) != row(motion.v, q);
      if (!apart && springs.stiffness[lane] > 0 && !(body_.pinned[p] && body_.pinned[q])) return true;
    }
  return false;
}

StepStatus SoftBody::advance(double H) {
  backup_ = now_;
  divided_ = 1;
  const Attempt usual{H, settings.step > 0 ? 1 : now_.watch.share, stale_};
  const Material before = material_;
  StepStatus status = advance_from_here(H, usual.share);
  const bool astray = status == StepStatus::too_many_steps && now_.course.work > backup_.course.work;  // not from the start
  if (status == StepStatus::not_finite || astray)
    status = divide(usual, status);
  else if (status == StepStatus::ok && settings.step == 0 && !now_.watch.hopeless && gains_energy())
    status = take_back_gain(usual);
  if (status == StepStatus::ok) return status;
  if (usual.stale) {  // outputs are again those of the material before
    const Material wanted = std::exchange(static_cast<Material&>(settings), before);
    refresh_body();
    static_cast<Material&>(settings) = wanted;
  }
  now_ = backup_;
  stale_ = usual.stale;
  return status;
}

StepStatus SoftBody::try_again(const Attempt& attempt, const EnergyWatch& watch) {
  now_ = backup_;
  now_.watch = watch;
  stale_ = attempt.stale;
  return advance_from_here(attempt.H, attempt.share);
}

/// The state went astray: tries smaller internal steps, as long as that is not too much work.
StepStatus SoftBody::divide(Attempt attempt, StepStatus failure) {
  double work = now_.course.work - backup_.course.work;
  for (int halvings = 0; halvings < most_halvings && 2 * work <= trial_work; ++halvings) {
    attempt.share /= 2;
    divided_ *= 2;
    const StepStatus status = try_again(attempt, backup_.watch);
    if (status != StepStatus::not_finite && status != StepStatus::too_many_steps) return status;
    work += now_.course.work - backup_.course.work;
  }
  return failure;
}

/// The body has gained energy at automatic steps: smaller ones from here on, and in this step already if it was the one. If they
/// do not help the step stands.
StepStatus SoftBody::take_back_gain(const Attempt& usual) {
  const double gained = now_.watch.gained;
  double work = now_.course.work - backup_.course.work;
  EnergyWatch start = backup_.watch;
  if (!usual.stale && start.kinetic_elastic >= 0) {
    start.jolt(body_, backup_.motion.spring, backup_.outside, around_.force);
    start.look({body_, around_}, backup_.motion, staggered_step(backup_.course), 0);
    start.jolt(body_, backup_.motion.spring, around_.force, backup_.outside);
  }
  const double gained_before = start.gained;
  start.gained = start.due = 0;
  Attempt attempt = usual;
  while (attempt.share > least_share && 2 * work <= trial_work) {
    attempt.share /= 2;
    if (try_again(attempt, start) != StepStatus::ok) break;
    work += now_.course.work - backup_.course.work;
    now_.watch.share = attempt.share;
    if (now_.watch.gained <= mended_share * (gained - gained_before) || gained_before > (1 - mended_share) * gained) return StepStatus::ok;
  }
  start = backup_.watch;
  start.hopeless = true;
  return try_again(usual, start);
}

/// Books what moved points without the body's own motion. Returns what of the exchange's work is booked already.
double SoftBody::open_watch(bool changed, bool moved) {
  EnergyWatch& watch = now_.watch;
  const State &motion = now_.motion, &before = backup_.motion;
  const bool far = moved && (motion.x - before.x).abs().maxCoeff() > small_jump * body_.length;
  if (watch.kinetic_elastic < 0 || changed || far) {
    watch.start({body_, around_}, motion, now_.course.work);
    return now_.exchange.work;
  }
  if (moved) watch.received -= 0.5 * ((motion.spring + before.spring) * (motion.x - before.x)).sum();
  return 0;
}

/// The same with and without energy outputs: what only they have counted is not read.
void SoftBody::close_watch(double booked) {
  EnergyWatch& watch = now_.watch;
  if (now_.course.method == Method::backward_euler) {  // has a guard of its own
    watch.kinetic_elastic = -1;
    return;
  }
  const double taken = body_.damped ? 0 : now_.exchange.dissipated;
  watch.received += (around_.force * (now_.motion.x - begin_)).sum() + now_.exchange.work - booked - taken;
  if (now_.course.work >= watch.due) watch.look({body_, around_}, now_.motion, staggered_step(now_.course), now_.course.work);
}

double SoftBody::staggered_step(const Course& course) {
  return course.method == Method::leapfrog || course.method == Method::central_difference ? course.clock.h : 0;
}

double SoftBody::damped_spin() const {
  if (now_.course.method != Method::backward_euler) return 0;
  const auto spin = [&](const State& state) { return rigid_motion(body_.mass, state.x, state.v).spin.norm(); };
  return std::max(spin(backup_.motion), spin(now_.motion));
}

double SoftBody::lost_energy() const {
  if (now_.watch.kinetic_elastic < 0) return 0;
  EnergyWatch watch = now_.watch;
  watch.look({body_, around_}, now_.motion, staggered_step(now_.course), 0);
  return -watch.balance;
}

bool SoftBody::rubs_undamped() {
  if (body_.damped || settings.step == 0 || now_.exchange.contacts_resolved == 0) return false;
  const auto rubs = [](const Plane& plane) { return plane.friction > 0; };
  return std::any_of(around_.planes.begin(), around_.planes.end(), rubs) && internal_step() > rubbing_share * stable_step();
}

}  // namespace softffd
