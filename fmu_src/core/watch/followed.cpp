#include "watch/followed.hpp"

#include <algorithm>

namespace softffd {

namespace {

/// The longest stable step is two radians of the fastest vibration.
constexpr double half = 0.5;

}  // namespace

FollowedPoints::FollowedPoints(const Sensed& sensed, const Lattice& lattice) : begun_(sensed.followed.size(), Vec3::Zero()) {
  for (const FollowedPoint& point : sensed.followed) {
    followed_.push_back({embed(sensed.basis, lattice, point.at), std::nullopt, point.maximum});
    if (point.stress) followed_.back().place.emplace(lattice, point.at);
    every_step_ = every_step_ || point.maximum;
  }
}

void FollowedPoints::begin(const Model& model, Run& run, bool continued) {
  const State& motion = run.physical.motion;
  if (every_step_) radian_ = half * model.stability.stable_step(model.body, motion.x);
  if (continued) return;
  for (std::size_t n = 0; n < followed_.size(); ++n) {
    begun_[n] = followed_[n].value(motion.v);
    run.physical.exchange.points[n] = {.from = begun_[n]};
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

void FollowedPoints::end(const Body& body, double H, Run& run) const {
  const State& motion = run.physical.motion;
  for (std::size_t n = 0; n < followed_.size(); ++n) {
    PointReading& reading = run.physical.exchange.points[n];
    reading.acceleration = (followed_[n].value(motion.v) - begun_[n]) / H;
    if (followed_[n].maximum) look(body, followed_[n], reading.acceleration.norm(), motion, reading);
  }
}

}  // namespace softffd
