#include "watch/sensors.hpp"

#include <algorithm>

#include "contact/surface/tangents.hpp"

namespace softffd {

namespace {

/// Distance of differences along the surface, as a fraction of the largest side of the box.
constexpr double apart = 1e-4;
/// Least fraction of a place's area that counts if the area faces the obstacle from the side.
constexpr double least_facing = 1e-3;
/// Gap within which a sample takes part in a load, as a fraction of the shortest side of a cell.
constexpr double near_by = 1.0 / 16;
/// An area counts as touched if its pressure is above this fraction of the largest pressure.
constexpr double pressed_part = 0.01;

}  // namespace

Sensors::Sensors(const Sensed& sensed, const Lattice& lattice, const Samples* samples)
    : sensed_(sensed), lattice_(lattice), samples_(samples), rest_(rest_positions(lattice)) {
  if (samples) spread_.emplace(*samples);
}

/// Returns the present outward area vector of the surface at a place [m2]: two directions along the surface move with the material.
Vec3 Sensors::area(int at, const Points& x) const {
  const Vec3& rest = sensed_.areas[at];
  const double size = rest.norm();
  if (!(size > 0)) return Vec3::Zero();
  const Vec3 normal = rest / size, here = samples_ ? samples_->place(at) : row(rest_, at);
  const Vec3 first = normal.unitOrthogonal();
  const auto stretched = [&](const Vec3& along) {
    std::array<Vec3, 2> ends, moved;
    for (const int end : {0, 1}) {
      Vec3& place = ends[end] = here + (end ? 1 : -1) * apart * lattice_.largest_side() * along;
      place = place.cwiseMax(lattice_.origin).cwiseMin(lattice_.origin + lattice_.size);
      const Embedding embedding = embed(sensed_.basis, lattice_, place);
      for (int axis = 0; axis < 3; ++axis) moved[end][axis] = embedding(x.col(axis));
    }
    const Vec3 change = moved[1] - moved[0];
    return Vec3(change / (ends[1] - ends[0]).dot(along));
  };
  return size * stretched(first).cross(stretched(normal.cross(first)));
}

/// Collects the places that touch this obstacle, and the samples near it, with the obstacle's impulses on them.
void Sensors::find_touches(const Plane& obstacle, double within, const Points& impulses, const State& motion) {
  touches_.clear();
  const double near = near_by * lattice_.cell().minCoeff();
  const SolidPose pose = obstacle.pose_at(motion.time);
  const HalfSpace whole = obstacle.at(motion.time);
  for (int at = 0; at < impulses.rows(); ++at) {
    const Vec3 here = place(at, motion.x), impulse = row(impulses, at);
    const bool pushed = !impulse.isZero(0);
    if (!pushed && !spread_) continue;
    const HalfSpace plane = obstacle.solid() ? tangent(obstacle, pose, here) : whole;
    const double gap = plane.gap(here);
    if (!pushed && !(gap <= std::max(near, within))) continue;
    const double facing = -plane.normal.dot(area(at, motion.x)), least = least_facing * sensed_.areas[at].norm();
    if (pushed || facing > least) touches_.push_back({at, pushed || gap <= within, std::max(facing, least), here, plane.normal, impulse});
  }
  load_.take(touches_);
}

void Sensors::read(const Drive& drive, double within, double time, Run& run) {
  const int count = int(sensed_.areas.size());
  force_.setZero(count, 3);
  for (Scalars* each : {&pressing_, &area_, &largest_}) each->setZero(count);
  for (std::size_t q = 0; q < drive.planes.size(); ++q) {
    const Points& impulses = run.physical.exchange.touched[q];
    if (impulses.isZero(0)) continue;
    find_touches(drive.planes[q], within, impulses, run.physical.motion);
    if (spread_) spread_->distribute(load_);
    const Scalars pressure = (load_.area > 0).select(load_.along / load_.area, 0.0);
    const double faint = pressed_part * pressure.maxCoeff();
    for (int t = 0; t < load_.count(); ++t) {
      const int at = load_.samples[t];
      force_.row(at) += load_.force(t).array().transpose();
      pressing_[at] += load_.along[t];
      if (pressure[t] > faint) area_[at] += load_.area[t];
      largest_[at] = std::max(largest_[at], pressure[t]);
    }
  }
  for (std::size_t n = 0; n < sensed_.patches.size(); ++n) show(sensed_.patches[n], run, 1 / time, run.sensors[n]);
}

void Sensors::show(const Patch& patch, const Run& run, double once, SensorReading& reading) const {
  Points taxels = std::move(reading.taxels);
  taxels.setZero();
  reading = {};
  Vec3 centre = Vec3::Zero();
  double whole = 0, pressing = 0;
  for (std::size_t n = 0; n < patch.places.size(); ++n) {
    centre += patch.weights[n] * place(patch.places[n], run.physical.motion.x);
    whole += patch.weights[n];
  }
  centre /= whole;
  for (const int at : patch.places) {
    const Vec3 force = once * row(force_, at);
    reading.force += force;
    reading.torque += (place(at, run.physical.motion.x) - centre).cross(force);
    reading.area += area_[at];
    pressing += once * pressing_[at];
    reading.peak = std::max(reading.peak, once * largest_[at]);
  }
  for (const auto& [at, taxel, fraction] : patch.fractions) taxels.row(taxel) += fraction * once * force_.row(at);
  if (reading.area > 0) reading.pressure = pressing / reading.area;
  reading.taxels = std::move(taxels);
}

}  // namespace softffd
