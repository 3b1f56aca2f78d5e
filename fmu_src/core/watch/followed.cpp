#include "watch/followed.hpp"

#include <algorithm>

namespace softffd {

namespace {

/// The longest stable step is two radians of the fastest vibration.
constexpr double half = 0.5;

}  // namespace

FollowedPoints::FollowedPoints(const Sensed& sensed, const Lattice& lattice) {
  for (const FollowedPoint& point : sensed.followed) {
    followed_.push_back({embed(sensed.basis, lattice, point.at), std::nullopt, point.maximum});
    if (point.stress) followed_.back().place.emplace(lattice, point.at);
    every_step_ = every_step_ || point.maximum;
  }
}

void FollowedPoints::start(Run& run) const {
  for (std::size_t n = 0; n < followed_.size(); ++n) run.physical.exchange.points[n] = {.begun = followed_[n].value(run.physical.motion.v)};
}

void FollowedPoints::begin(const Model& model, Run& run) {
  const State& motion = run.physical.motion;
  if (every_step_) radian_ = half * model.stability.stable_step(model.body, motion.x);
  for (std::size_t n = 0; n < followed_.size(); ++n) {
    PointReading& reading = run.physical.exchange.points[n];
    reading = {.begun = reading.begun, .from = followed_[n].value(motion.v)};
  }
}

void FollowedPoints::look(const Body& body, const Followed& each, double acceleration, const State& motion, PointReading& reading) const {
  reading.speed = std::max(reading.speed, each.value(motion.v).norm());
  reading.largest_acceleration = std::max(reading.largest_acceleration, acceleration);
  if (!each.place) return;
  const double stress = static_cast<const Solid&>(*body.energies.front()).at(*each.place, motion.x).von_mises();
  reading.von_mises = std::max(reading.von_mises, stress);
}

void FollowedPoints::step(const Body& body, double h, Run& run) const {
  const State& motion = run.physical.motion;
  for (std::size_t n = 0; n < followed_.size(); ++n) {
    const Followed& each = followed_[n];
    if (!each.maximum) continue;
    PointReading& reading = run.physical.exchange.points[n];
    double acceleration = 0;
    if ((reading.since += h) >= radian_) {
      const Vec3 now = each.value(motion.v);
      acceleration = (now - reading.from).norm() / reading.since;
      reading.from = now;
      reading.since = 0;
    }
    look(body, each, acceleration, motion, reading);
  }
}

void FollowedPoints::end(const Body& body, double time, const Run& before, Run& run) const {
  if (time == 0) run.physical.exchange.points = before.physical.exchange.points;
  if (time == 0) return;
  const State& motion = run.physical.motion;
  for (std::size_t n = 0; n < followed_.size(); ++n) {
    PointReading& reading = run.physical.exchange.points[n];
    const Vec3 now = followed_[n].value(motion.v);
    reading.acceleration = (now - reading.begun) / time;
    reading.begun = now;
    if (followed_[n].maximum) look(body, followed_[n], reading.acceleration.norm(), motion, reading);
  }
}

}  // namespace softffd
