/// How large a step the tolerance allows, and which method does the least work: the trials of the propagator.
#include <algorithm>
#include <cmath>

#include "propagator.hpp"
#include "traits.hpp"
#include "vibration.hpp"

namespace softffd {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
/// Share of the tolerance that the summed errors of a fixed-step method may take by forecast.
constexpr double summed_share = 1.5;
/// Work between two calibrations, in multiples of a calibration's own.
constexpr double calibration_pause = 10;
/// The same for races, and its limit while the winner stays.
constexpr double race_pause = 10, longest_race_pause = 160;
/// Where contact makes a trial's difference jump, the step is not cut below this share of the stable one.
constexpr double least_in_contact = 1.0 / 500;

double power(double base, int exponent) {
  double product = 1;
  for (int i = 0; i < exponent; ++i) product *= base;
  return product;
}

}  // namespace

long divisions(double length, double limit) { return std::max(1L, long(std::ceil(length / limit * (1 - 1e-12)))); }

double root(double value, int exponent, double low, double high) {
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (power(middle, exponent) < value ? low : high) = middle;
  }
  return low;
}

double Propagator::calibrate(const Job& job, Method method, double H, int rounds) {
  const Traits t = traits(method);
  Calibration& calibration = method == Method::bm4 ? job.course.bm4 : job.course.leapfrog;
  const double window = stability_.any_frequency() > 0 ? std::min(H, 40 / bound(job)) : H;
  const double allowed = summed_share * job.request.tolerance;
  const double pairs = power(2, t.order), c = pairs / (pairs - 1);
  const bool harmless = vibration(job.equations, job.state, time_scale_) <= allowed;
  double h = std::min({H, step_limit(job, method, false), calibration.h > 0 ? calibration.h : infinity}), work = 0;
  for (int round = 0; round < rounds && !harmless; ++round) {
    const long steps = std::min(divisions(window, h), method == Method::bm4 ? 16L : 40L);
    h = std::min(h, window / double(steps));
    const double error = c * trial_error(job, method, h, steps);
    work += 3 * double(steps) * t.work;
    const double factor = error > 0 ? root(std::min(1e30, allowed / error), t.order, 1e-4, 4) : 4;
    calibration.h = h * factor;
    if (factor > 0.35) break;
    h = calibration.h;
  }
  if (harmless) calibration.h = infinity;
  if (!job.equations.around.planes.empty()) calibration.h = std::max(calibration.h, least_in_contact * step_limit(job, method, false));
  calibration.due = job.course.work + std::max(calibration_pause * work, 100.0);
  return work;
}

/// What h and h / 2 differ by at the end of the run, if the difference after some steps keeps growing until damping forgets it.
double Propagator::trial_error(const Job& job, Method method, double h, long steps) {
  coarse_ = fine_ = job.state;
  const double stretch = double(steps) * h;
  for (State* state : {&coarse_, &fine_}) {
    const long parts = state == &fine_ ? 2 : 1;
    const Task task{job.state.time, 0, h / double(parts), steps * parts};
    if (take_steps(job, method, task, *state, scratch_) != StepStatus::ok) return 0;
  }
  double error = 0;
  for (int i = 0; i < memory_.size(); ++i) {
    const double dx = std::abs(coarse_.x.data()[i] - fine_.x.data()[i]);
    const double dv = std::abs(coarse_.v.data()[i] - fine_.v.data()[i]) * time_scale_[i];
    error = std::max(error, std::max(dx, dv) * std::max(1.0, std::min(job.request.horizon, memory_[i]) / stretch));
  }
  return error;
}

void Propagator::choose(const Job& job, double H) {
  Course& course = job.course;
  if (course.favourite == Method::automatic || course.work >= course.race_due) race(job, H);
  course.method = course.favourite;
  course.reason = course.favourite_reason;
}

void Propagator::race(const Job& job, double H) {
  Course& course = job.course;
  const auto fixed_work = [&](Method method, const Calibration& calibration) {
    return double(divisions(H, std::min(step_limit(job, method, false), calibration.h))) * traits(method).work;
  };
  const Method before = course.favourite;
  double spent = calibrate(job, Method::leapfrog, H, 1);
  double best = fixed_work(Method::leapfrog, course.leapfrog);
  Method winner = Method::leapfrog;
  const auto consider = [&](Method method, double work) {
    if (work * (method == before ? 1.0 : 1.1) < best) best = work, winner = method;
  };
  const double least = H / step_limit(job, Method::leapfrog, false) * traits(Method::leapfrog).work;
  const bool stable_is_enough = best < 1.7 * least;
  if (!stable_is_enough) {
    const Method adaptive = job.equations.body.damped ? Method::dop853 : Method::rkn12;
    consider(adaptive, controlled_work(job, adaptive, H, spent));
    spent += calibrate(job, Method::bm4, H, 2);
    consider(Method::bm4, fixed_work(Method::bm4, course.bm4));
    if (winner == Method::leapfrog) spent += calibrate(job, Method::leapfrog, H, 3);
  }
  course.favourite = winner;
  course.favourite_reason = winner == Method::leapfrog && stable_is_enough ? Reason::stability : Reason::least_work;
  course.race_pause = winner == before ? std::min(2 * course.race_pause, longest_race_pause) : race_pause;
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

}  // namespace softffd
