#include "stepping/race.hpp"

#include <algorithm>

#include "kit/limits.hpp"
#include "kit/thresholds.hpp"
#include "kit/trial.hpp"
#include "methods/ros34pw2.hpp"
#include "model/arithmetic.hpp"
#include "stepping/controlled_steps.hpp"
#include "watch/vibration.hpp"

namespace softffd {

namespace thresholds {

/// Rounds of a calibration in a race: the first of leapfrog, of bm4, the others of leapfrog.
constexpr int race_rounds = 1, race_rounds_bm4 = 2, race_rounds_left = 3;
/// Work between two races, in multiples of a race's own, and its limit while the winner stays [1]; after a jolt. Measured before the pause
/// was bound to their work: races took 5 to 30 % of a run of a second. Now a tenth at most, and less while the winner stays.
constexpr double race_pause = 10, longest_race_pause = 160, race_pause_after_jolt = 3;
/// Work that a trial of implicit steps may take.
constexpr double longest_trial = 20'000;
/// By how many steps in the place of one implicit one it is seen that the fastest mode creeps.
constexpr Count creep_parts = 16;
/// Vibrations with time scales above this many implicit steps are resolved by their error control [1]. By experience.
constexpr double resolved = 8;
/// Stretch of the trial of a method with error control in units of 1 / omega [1]: some steps, until it has found their size.
constexpr double controlled_window = 30;

}  // namespace thresholds

namespace {

namespace use = thresholds;

double fixed_work(const Job& job, Method method, double H) {
  const double h = tighter(step_limit(job, method, false), job.run.course.calibration(method).h);
  return double(divisions(H, h)) * step_work(job.model.body, method, h);
}

}  // namespace

bool Race::due(const Job& job, double H) {
  const Course& course = job.run.course;
  const bool due = course.work >= (job.request.jolt ? course.race.soon : course.race.due) && H >= use::sliver * course.usual;
  return course.race.winner == Method::automatic || due || use::sliver * H > course.race.window;
}

void Race::run(Integrators& integrators, Calibrator& calibrator, const Job& job, double H) {
  const auto calibrate = [&](Method method, int rounds) { spent_ += calibrator.calibrate(integrators, job, method, H, rounds); };
  const Body& body = job.model.body;
  spent_ = 0;
  Contest contest;
  contest.before = job.run.course.race.winner;
  const double longest = step_limit(job, Method::leapfrog, false), each = step_work(body, Method::leapfrog, longest);
  contest.least = std::max(1.0, H / longest) * each;
  const double slower = each / traits(Method::leapfrog).work;  // by internal damping, which implicit steps hardly feel
  const bool may_pay = job.model.stability.elastic() && implicit_may_pay(slower * H * bound(job));
  if (may_pay) try_implicit(integrators, job, H, contest.least, contest);
  if (!(contest.implicit_work < infinity)) {
    calibrate(Method::leapfrog, use::race_rounds);
    contest.leapfrog = fixed_work(job, Method::leapfrog, H);
    if (!leapfrog_is_enough(contest)) {
      contest.adaptive = body.damped ? Method::dop853 : Method::rkn12;
      const double least = H / step_limit(job, contest.adaptive, false) * traits(contest.adaptive).work;  // by internal damping much
      if (!body.dashpots() || least < contest.leapfrog) contest.adaptive_work = controlled_work(integrators, job, contest.adaptive, H);
      if (!body.dashpots()) {
        calibrate(Method::bm4, use::race_rounds_bm4);
        contest.bm4 = fixed_work(job, Method::bm4, H);
      }
      if (may_pay && body.dashpots()) try_implicit(integrators, job, H, settle(contest).work, contest);
      if (settle(contest).method == Method::leapfrog) calibrate(Method::leapfrog, use::race_rounds_left);
    }
  }
  const Winner winner = settle(contest);
  RaceRecord& record = job.run.course.race;
  const double work = job.run.course.work;
  record.winner = winner.method;
  record.reason = winner.reason;
  record.forecast = winner.work;
  record.window = H;
  record.pause = winner.method == contest.before ? std::min(2 * record.pause, use::longest_race_pause) : use::race_pause;
  record.soon = work + std::max(use::race_pause_after_jolt * spent_, use::shortest_pause);
  record.due = work + std::max(record.pause * spent_, use::shortest_pause);
}

/// Without touching a matrix first: could implicit steps pay, and is there nothing that vibrates by more than they may ignore? others: the
/// work of the others. First that of leapfrog at its stability limit, of which strong internal damping leaves little accuracy: where the
/// tolerance asks for much more, the race comes back with that.
void Race::try_implicit(Integrators& integrators, const Job& job, double H, double others, Contest& contest) {
  const State& motion = job.run.path.motion;
  contest.implicit = implicit_method(!job.drive.pins.empty(), H * bound(job), turning_limit(job, motion.x, motion.v) < H);
  const double step_work = integrators.implicit_work().step;
  if (!implicit_may_win(H / step_limit(job, contest.implicit, false) * step_work, others)) return;
  const double shortest = H * step_work / (use::implicit_gain * others);  // step that would still pay
  if (too_loud(present_vibration(job.equations(), motion, job.model.time_scale, use::resolved * shortest), job.request.tolerance)) return;
  const double budget = std::min(use::implicit_gain * others, use::longest_trial);
  contest.implicit_work = implicit_work(integrators, job, contest.implicit, H, budget);
}

/// Does one implicit step agree with explicit ones that resolve everything? Error estimates of implicit steps do not see what they damp.
/// Where internal damping leaves fast modes no vibration, shorter implicit ones do: explicit ones err there themselves.
bool Race::fast_modes_are_quiet(Integrators& integrators, const Job& job, Method method, double H) {
  const ImplicitWork& implicit = integrators.implicit_work();
  State& motion = job.run.path.motion;
  const bool creeps = job.model.body.shortest_time() * bound(job) >= use::creeping && job.model.body.dashpots();
  const double longest = creeps ? step_limit(job, method, false) : infinity;  // no step of it turns the body further
  const double way = std::min({H, use::calibration_window / bound(job), longest}), begin = motion.time;
  const Method fine = creeps ? method : Method::leapfrog;
  const Count steps = creeps ? use::creep_parts : divisions(way, step_limit(job, Method::leapfrog, false));
  const double each = creeps ? implicit.step : step_work(job.model.body, fine, way / double(steps));
  spent_ += double(steps) * each + implicit.step + implicit.factor;
  Trial trial(job.run, start_);
  if (integrators.take(job, fine, {begin, 0, way / double(steps), steps}).status != StepStatus::ok) return false;
  std::swap(fine_, motion);
  trial.back();
  OneStep& step = integrators.one_step(method);
  integrators.budget().spend(step.offer(job.model, job.drive, begin, way, job.run).work);
  fine_.x -= step.x;
  fine_.v -= step.v;
  const std::size_t n = fine_.x.size();
  const double by_velocity = kernels::largest_weighted(n, job.model.time_scale.data(), fine_.v.data());
  return quiet(worse(kernels::largest(n, fine_.x.data()), by_velocity), job.request.tolerance);
}

/// Work of an implicit method for H, by doing it; infinite beyond the budget, or where fast modes that it would damp are at work.
double Race::implicit_work(Integrators& integrators, const Job& job, Method method, double H, double budget) {
  if (!fast_modes_are_quiet(integrators, job, method, H)) return infinity;
  Run& run = job.run;
  Trial trial(run, start_);
  const Run& before = trial.before();
  const double end = run.path.motion.time + H;
  const StepStatus status = run_controlled(integrators, job, method, end, run.course.work + budget);
  const double work = run.course.work - before.course.work;
  spent_ += work;
  if (status != StepStatus::ok || run.path.motion.time < end) return infinity;
  const double passed_over = use::resolved * run.course.controlled_step(method);
  if (too_loud(present_vibration(job.equations(), before.path.motion, job.model.time_scale, passed_over), job.request.tolerance))
    return infinity;
  trial.keep();
  // a factor is kept for later communication steps
  const double made = double(run.course.factors - before.course.factors), used = std::max(1.0, double(run.path.steps - before.path.steps));
  return work - integrators.implicit_work().factor * std::max(0.0, made - used / double(Ros34pw2::most_uses));
}

double Race::controlled_work(Integrators& integrators, const Job& job, Method method, double H) {
  const double window = std::min(H, use::controlled_window / bound(job));
  double h = 0;
  {
    Trial trial(job.run, start_);
    const StepStatus status = run_controlled(integrators, job, method, job.run.path.motion.time + window, infinity);
    spent_ += job.run.course.work - trial.before().course.work;
    if (status != StepStatus::ok) return infinity;
    h = job.run.course.controlled_step(method);
  }
  job.run.course.controlled_step(method) = h;
  return double(divisions(H, tighter(h, step_limit(job, method, false)))) * traits(method).work;
}

}  // namespace softffd
