/// How large a step the tolerance allows, and which method does the least work: the trials of the propagator.
#include <algorithm>
#include <cmath>

#include "methods/traits.hpp"
#include "model/arithmetic.hpp"
#include "stepping/propagator.hpp"
#include "watch/vibration.hpp"

namespace softffd {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
/// Work between two calibrations, in multiples of a calibration's own.
constexpr double calibration_pause = 10;
/// A communication step shorter than this share of those of late is no measure for the others.
constexpr double sliver = 0.2;
/// Both where the outside forces have just jumped.
constexpr double jolt_pause = 3;
/// The same for races, and its limit while the winner stays.
constexpr double race_pause = 10, longest_race_pause = 160;
/// A challenger has to need this much less work than the last winner.
constexpr double challenge = 1.2;
/// Implicit steps are worth a trial from this H omega / 2 on.
constexpr double stiff = 25;
/// For a body that turns freely, whose frame takes work too.
constexpr double stiff_turning = 100;
/// Work that such a trial may take.
constexpr double longest_trial = 20'000;
/// Share of the tolerance that fast modes may amount to where an implicit method is to pass over them.
constexpr double quiet_share = 0.3;
/// Vibrations with time scales above this many implicit steps are resolved by its error control.
constexpr double resolved = 8;

}  // namespace

bool Propagator::calibration_due(const Job& job, const Calibration& calibration, double H, bool jolt) {
  const Course& course = job.course;
  if (calibration.h == 0) return true;
  if (H < sliver * course.usual) return false;
  const double window = stability_.any_frequency() > 0 ? std::min(H, 40 / bound(job)) : H;
  return course.work >= (jolt ? calibration.soon : calibration.due) || sliver * window > calibration.window;
}

double Propagator::calibrate(const Job& job, Method method, double H, int rounds) {
  const Traits t = traits(method);
  Calibration& calibration = method == Method::bm4 ? job.course.bm4 : job.course.leapfrog;
  const double window = stability_.elastic() ? std::min(H, 40 / bound(job)) : H;
  const double allowed = forecast_share * job.request.tolerance;
  const double pairs = power(2, t.order), c = pairs / (pairs - 1);
  const bool harmless = vibration(job.equations, job.state, time_scale_) <= allowed;
  double h = std::min({H, step_limit(job, method, false), calibration.h > 0 ? calibration.h : infinity}), work = 0;
  for (int round = 0; round < rounds && !harmless; ++round) {
    const Count steps = std::min(divisions(window, h), method == Method::bm4 ? Count{16} : Count{40});
    h = std::min(h, window / double(steps));
    const double error = c * trial_error(job, method, h, steps);
    work += 3 * double(steps) * t.work;
    const double factor = error > 0 ? root(std::min(1e30, allowed / error), t.order, 1e-4, 4) : 4;
    calibration.h = h * factor;
    if (factor > 0.35) break;
    h = calibration.h;
  }
  if (harmless) calibration.h = infinity;
  calibration.window = window;
  calibration.soon = job.course.work + std::max(jolt_pause * work, 100.0);
  calibration.due = job.course.work + std::max(calibration_pause * work, 100.0);
  return work;
}

/// What h and h / 2 will differ by at the end of the run.
double Propagator::trial_error(const Job& job, Method method, double h, Count steps) {
  coarse_ = fine_ = job.state;
  const double stretch = double(steps) * h;
  for (State* state : {&coarse_, &fine_}) {
    const Count parts = state == &fine_ ? 2 : 1;
    const Span span{job.state.time, 0, h / double(parts), steps * parts};
    if (take_steps(job, method, span, *state, scratch_) != StepStatus::ok) return 0;
  }
  return growing(job, coarse_, fine_, stretch);
}

double Propagator::growing(const Job& job, const State& a, const State& b, double stretch) const {
  double error = 0;
  for (int i = 0; i < memory_.size(); ++i) {
    const double dx = std::abs(a.x.data()[i] - b.x.data()[i]), dv = std::abs(a.v.data()[i] - b.v.data()[i]) * time_scale_[i];
    error = std::max(error, std::max(dx, dv) * std::max(1.0, std::min(job.request.horizon, memory_[i]) / stretch));
  }
  return error;
}

void Propagator::choose(const Job& job, double H) {
  Course& course = job.course;
  const bool due = course.work >= (job.request.jolt ? course.race_soon : course.race_due) && H >= sliver * course.usual;
  if (course.favourite == Method::automatic || due || sliver * H > course.race_window) race(job, H);
  course.method = course.favourite;
  course.reason = course.favourite_reason;
}

/// The implicit method for H: the one in the body's frame where the other would have to cut its steps because the body turns.
Method Propagator::implicit_method(const Job& job, double H) {
  const bool free = job.equations.around.pins.empty() && H * bound(job) > 2 * stiff_turning;
  return free && turning_limit(job, job.state.x, job.state.v) < H ? Method::floating_frame : Method::ros34pw2;
}

/// Without touching a matrix: could implicit steps pay, and is there nothing that vibrates by more than they may ignore?
bool Propagator::worth_a_matrix(const Job& job, Method method, double H, double least) {
  if (H / step_limit(job, method, false) * implicit_.step > 0.8 * least) return false;
  const double shortest = H * implicit_.step / (0.8 * least);  // step that would still pay
  return present_vibration(job.equations, job.state, time_scale_, resolved * shortest) <= 3 * job.request.tolerance;
}

void Propagator::race(const Job& job, double H) {
  Course& course = job.course;
  const auto fixed_work = [&](Method method, const Calibration& calibration) {
    return double(divisions(H, std::min(step_limit(job, method, false), calibration.h))) * traits(method).work;
  };
  const Method before = course.favourite;
  const double least = std::max(1.0, H / step_limit(job, Method::leapfrog, false)) * traits(Method::leapfrog).work;
  double spent = 0, best = infinity;
  Method winner = Method::leapfrog;
  const auto consider = [&](Method method, double work) {
    const auto handicapped = [&](Method which, double needed) { return which == before ? needed : challenge * needed; };
    if (handicapped(method, work) < handicapped(winner, best)) best = work, winner = method, course.favourite_reason = Reason::least_work;
  };
  if (ros34pw2_ && stability_.elastic() && H * bound(job) > 2 * stiff) {
    const Method implicit = implicit_method(job, H);
    if (worth_a_matrix(job, implicit, H, least))
      consider(implicit, implicit_work(job, implicit, H, std::min(0.8 * least, longest_trial), spent));
    if (winner == implicit) take_trial(job);
    if (winner == Method::ros34pw2) course.favourite_reason = Reason::quiet_stiffness;
    if (winner == Method::floating_frame) course.favourite_reason = Reason::free_flight;
  }
  if (!is_implicit(winner)) {
    spent += calibrate(job, Method::leapfrog, H, 1);
    best = fixed_work(Method::leapfrog, course.leapfrog);
    course.favourite_reason = Reason::stability;
    if (best > 1.7 * least) {
      course.favourite_reason = Reason::least_work;
      const Method adaptive = job.equations.body.damped ? Method::dop853 : Method::rkn12;
      consider(adaptive, controlled_work(job, adaptive, H, spent));
      spent += calibrate(job, Method::bm4, H, 2);
      consider(Method::bm4, fixed_work(Method::bm4, course.bm4));
      if (winner == Method::leapfrog) spent += calibrate(job, Method::leapfrog, H, 3);
    }
  }
  course.favourite = winner;
  course.forecast = best;
  course.race_window = H;
  course.race_pause = winner == before ? std::min(2 * course.race_pause, longest_race_pause) : race_pause;
  course.race_soon = course.work + std::max(jolt_pause * spent, 100.0);
  course.race_due = course.work + std::max(course.race_pause * spent, 100.0);
}

double Propagator::controlled_work(const Job& job, Method method, double H, double& spent) {
  coarse_ = job.state;
  trial_course_ = job.course;
  const Job trial{job.equations, job.request, coarse_, trial_course_, scratch_};
  const StepStatus status = run_controlled(trial, method, job.state.time + std::min(H, 30 / bound(job)), infinity);
  spent += trial_course_.work - job.course.work;
  if (status != StepStatus::ok) return infinity;
  const double h = controlled_step(job.course, method) = controlled_step(trial_course_, method);
  return double(divisions(H, std::min(h, step_limit(job, method, false)))) * traits(method).work;
}

/// Work of an implicit method for H, by doing it; infinite beyond the budget, or where fast modes that it would damp are at work. The
/// trial ends in coarse_, trial_course_ and scratch_.
double Propagator::implicit_work(const Job& job, Method method, double H, double budget, double& spent) {
  if (!fast_modes_are_quiet(job, method, H, spent)) return infinity;
  coarse_ = job.state;
  trial_course_ = job.course;
  scratch_ = job.exchange;
  const Job trial{job.equations, job.request, coarse_, trial_course_, scratch_};
  const double end = job.state.time + H;
  const StepStatus status = run_controlled(trial, method, end, job.course.work + budget);
  const double work = trial_course_.work - job.course.work;
  spent += work;
  if (status != StepStatus::ok || coarse_.time < end) return infinity;
  const double passed_over = resolved * controlled_step(trial_course_, method);
  if (present_vibration(job.equations, job.state, time_scale_, passed_over) > 3 * job.request.tolerance) return infinity;
  // a factor is kept for later communication steps
  const double made = double(trial_course_.factors - job.course.factors),
               used = std::max(1.0, double(trial_course_.steps - job.course.steps));
  return work - implicit_.factor * std::max(0.0, made - used / double(Ros34pw2::most_uses));
}

/// The trial of implicit_work is the communication step.
void Propagator::take_trial(const Job& job) {
  std::swap(job.state, coarse_);
  std::swap(job.course, trial_course_);
  std::swap(job.exchange, scratch_);
}

/// Does one implicit step agree with explicit ones that resolve everything? Error estimates of implicit steps do not see what they damp.
bool Propagator::fast_modes_are_quiet(const Job& job, Method method, double H, double& spent) {
  const double way = std::min(H, 40 / bound(job));
  const Count steps = divisions(way, step_limit(job, Method::leapfrog, false));
  fine_ = job.state;
  const Span span{job.state.time, 0, way / double(steps), steps};
  spent += double(steps) * traits(Method::leapfrog).work + implicit_.step + implicit_.factor;
  if (take_steps(job, Method::leapfrog, span, fine_, scratch_) != StepStatus::ok) return false;
  trial_course_ = job.course;
  attempt({job.equations, job.request, job.state, trial_course_, scratch_}, method, job.state.time, way);
  fine_.x -= controlled(method).x;
  fine_.v -= controlled(method).v;
  const std::size_t n = fine_.x.size();
  const double difference = std::max(kernels::largest(n, fine_.x.data()), kernels::largest_weighted(n, time_scale_.data(), fine_.v.data()));
  return difference <= quiet_share * job.request.tolerance;
}

}  // namespace softffd
