#include "impacts/rest_steps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/feasible.hpp"
#include "contact/tolerances.hpp"
#include "flight/attitude.hpp"
#include "impacts/windows.hpp"
#include "kit/thresholds.hpp"
#include "kit/trial.hpp"
#include "model/arithmetic.hpp"

namespace softffd {

namespace {

namespace use = thresholds;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// The centre moves, and the attitude turns, by the mean of the velocities at both ends; the deformation stays.
void follow_mean_velocity(const Job& job, const State& from, double h) {
  const Body& body = job.model.body;
  State& motion = job.run.path.motion;
  const RigidMotion begin = rigid_motion(body.mass, from.x, from.v), end = rigid_motion(body.mass, motion.x, motion.v);
  Eigen::Matrix3d turned = Eigen::Matrix3d::Zero();
  for (int p = 0; p < body.points(); ++p)
    turned += body.mass[p] * (row(motion.x, p) - end.centre) * (row(from.x, p) - begin.centre).transpose();
  const Eigen::Matrix3d actual = rotation_next_to(turned), wanted = rotation_by(0.5 * h * (begin.spin + end.spin));
  const Eigen::Matrix3d correction = wanted * actual.transpose();
  const Vec3 centre = begin.centre + 0.5 * h * (begin.velocity + end.velocity);
  const bool turns = (correction - Eigen::Matrix3d::Identity()).norm() > 1e-14;
  for (int p = 0; p < body.points(); ++p) {
    const Vec3 arm = row(motion.x, p) - end.centre;
    set_row(motion.x, p, centre + (turns ? Vec3(correction * arm) : arm));
  }
}

}  // namespace

RestSteps::RestSteps(const Run& run) : start_(run.path), before_(run.path), coarse_(run.path), x_(run.path.motion.x) {
  obstacles_.reserve(run.path.exchange.planes.size());
}

StepStatus RestSteps::run(const Beside& at) {
  const Job& job = at.job;
  StiffContact& stiff = job.run.path.stiff;
  job.run.course.method = Method::backward_euler;
  job.run.course.reason = Reason::stiff_contact;
  job.run.energy.kinetic_elastic = -1;
  if (job.drive.pins.empty() && off_obstacles(job, use::lifted)) {
    stiff.begin(Phase::flight);
    return StepStatus::ok;
  }
  if (stiff.settling) return settle(at);
  const double time = job.run.path.motion.time, left = at.end - time;
  const double wanted = stiff.step > 0 ? std::min(stiff.step, left) : left;
  if (wanted < left && doubted(at, wanted)) return StepStatus::ok;
  const Count parts = divisions(left, wanted);
  const double next = parts == 1 ? at.end : time + left / double(parts);
  if (parts == 1 && stiff.rest_trust > 0 && step_once(at)) return StepStatus::ok;
  return step_twice(at, next);
}

/// Whether steps of h do not pay: back to windows, to listen for longer.
bool RestSteps::doubted(const Beside& at, double h) {
  StiffContact& stiff = at.job.run.path.stiff;
  if (h >= use::worth_resting * at.limit) return false;
  const Count doubts = std::min(stiff.doubts + 1, use::most_doubts);
  stiff.begin(Phase::contact);
  stiff.doubts = doubts;
  return true;
}

/// The first step takes up what velocities are left.
StepStatus RestSteps::settle(const Beside& at) {
  const Job& job = at.job;
  Path& path = job.run.path;
  const double time = path.motion.time, h = std::min(at.end - time, use::settling_steps * at.limit);
  Trial trial(path, start_);
  const Step taken = step(at, h < at.end - time ? time + h : at.end, true);
  if (taken.status == StepStatus::ok && taken.lost <= use::settling_loss * allowed_loss(job, path.stiff.pressing)) {
    path.stiff.error += use::quiet_energy * job.request.tolerance;
    path.stiff.settling = false;
    path.stiff.step = use::rest_growth * h;
    trial.keep();
    return StepStatus::ok;
  }
  trial.back();
  trial.keep();
  doubted(at, 0);
  return StepStatus::ok;
}

/// To the end, unless energy is lost: then nothing is trusted any more.
bool RestSteps::step_once(const Beside& at) {
  StiffContact& stiff = at.job.run.path.stiff;
  {
    Trial trial(at.job.run.path, start_);
    const Step taken = step(at, at.end, false);
    if (taken.status == StepStatus::ok && std::abs(taken.lost) < allowed_loss(at.job, taken.pressing)) {
      --stiff.rest_trust;
      stiff.pressing = taken.pressing;
      trial.keep();
      return true;
    }
  }
  stiff.rest_trust = 0;
  stiff.next_rest_trust = 1;
  return false;
}

StepStatus RestSteps::step_twice(const Beside& at, double next) {
  const Job& job = at.job;
  Path& path = job.run.path;
  StiffContact& stiff = path.stiff;
  const double tolerance = job.request.tolerance * power(job.request.step_factor, 2);
  const double time = path.motion.time, h = next - time;
  Trial trial(path, start_);
  Step taken = step(at, next, false);
  double error = infinity, lost = 0;
  if (taken.status == StepStatus::ok) {
    std::swap(coarse_, path);
    trial.back();
    for (const double until : {time + 0.5 * h, next}) {
      if (taken.status == StepStatus::ok) taken = step(at, until, false);
      lost += taken.lost;
    }
    if (taken.status == StepStatus::ok) error = outcome_of(job, coarse_.motion, path.motion, outlook(job, path.motion));
  }
  const double allowed = std::min(use::rest_share, use::rest_rate * h / left_of_run(job)) * tolerance;
  const double factor = error > 0 ? use::window_safety * std::sqrt(allowed / error) : use::rest_growth;
  const bool quiet = std::abs(lost) < allowed_loss(job, taken.pressing);
  if (error <= allowed && quiet) {
    const bool easy = next == at.end && error < use::easy_rest * allowed;
    if (easy) std::swap(path, coarse_);  // a step as those that are trusted: others would set off what is at rest
    if (h >= use::worth_resting * at.limit) stiff.doubts = 0;
    stiff.error += easy ? 2 * error : error;
    stiff.pressing = taken.pressing;
    stiff.step = h * std::clamp(factor, use::next_shrink, use::rest_growth);
    stiff.rest_trust = easy ? stiff.next_rest_trust : 0;
    stiff.next_rest_trust = easy ? std::min(2 * stiff.next_rest_trust, use::longest_rest_trust) : 1;
    trial.keep();
    return StepStatus::ok;
  }
  job.run.course.rejected += 2;
  trial.back();
  trial.keep();
  stiff.step = h * std::clamp(std::isfinite(error) ? factor : 0, use::window_shrink, quiet ? 0.5 : use::loss_shrink);
  doubted(at, stiff.step);
  return StepStatus::ok;
}

/// A step of backward Euler; unless settling its rigid motion takes the mean velocity.
RestSteps::Step RestSteps::step(const Beside& at, double until, bool settling) {
  const Job& job = at.job;
  Path& path = job.run.path;
  before_ = path;
  const State& from = before_.motion;
  const double h = until - from.time;
  path.clock = {from.time, h, 0};
  const double most = std::max(use::least_implicit_work, use::doubled_work * h / at.limit);
  const Outcome outcome = at.integrators.take(job, Method::backward_euler, {from.time, 0, h, 1, most});
  job.run.course.work += outcome.work;
  Step taken{outcome.status};
  if (taken.status != StepStatus::ok) return taken;
  path.motion.time = until;
  ++path.steps;
  for (std::size_t q = 0; q < job.drive.planes.size(); ++q) {
    const Vec3 impulse = path.exchange.planes[q].force - before_.exchange.planes[q].force;
    taken.pressing = std::max(taken.pressing, std::abs(impulse.dot(job.drive.planes[q].at(until).normal)) / h);
  }
  if (!job.drive.pins.empty()) return taken;
  x_ = path.motion.x;
  if (!settling && !job.model.body.samples) {  // a surface that turns rolls over its samples: no mean brings all of them back
    follow_mean_velocity(job, from, h);
    if (!keep_in_front(job)) taken.status = StepStatus::not_finite;
  }
  job.model.body.internal_force(path.motion.x, path.motion.spring);
  taken.lost = energy_lost(job, from, outcome.given);
  if (job.drive.watch) book_energies(job, from, x_, before_.exchange);
  return taken;
}

/// Brings the body as a whole back onto the obstacles that it touched before it was moved, and off those that it was moved behind.
bool RestSteps::keep_in_front(const Job& job) {
  Path& path = job.run.path;
  State& motion = path.motion;
  for (int round = 0; round < 3; ++round)
    for (std::size_t q = 0; q < job.drive.planes.size(); ++q) {
      const HalfSpace obstacle = job.drive.planes[q].at(motion.time);
      double least = infinity;
      for (int p = 0; p < motion.x.rows(); ++p) least = std::min(least, obstacle.gap(row(motion.x, p)));
      const bool touched = path.exchange.planes[q].force != before_.exchange.planes[q].force;
      if (least < 0 || (touched && round == 0))
        for (int axis = 0; axis < 3; ++axis) motion.x.col(axis) -= least * obstacle.normal[axis];
    }
  obstacles_.clear();
  for (const Plane& plane : job.drive.planes) obstacles_.push_back(plane.at(motion.time));
  for (int p = 0; p < motion.x.rows(); ++p) {
    Vec3 here = row(motion.x, p);
    for (const HalfSpace& obstacle : obstacles_)
      if (std::abs(obstacle.gap(here)) < use::snapped * job.model.body.length) here -= obstacle.gap(here) * obstacle.normal;
    push_out(obstacles_, here);
    for (const HalfSpace& obstacle : obstacles_)
      if (obstacle.gap(here) < -position_slack * (job.model.body.length + here.norm())) return false;
    set_row(motion.x, p, here);
  }
  return true;
}

}  // namespace softffd
