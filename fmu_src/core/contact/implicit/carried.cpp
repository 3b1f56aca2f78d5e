#include "contact/implicit/carried.hpp"

#include <algorithm>

#include "contact/surface/tangents.hpp"
#include "contact/tolerances.hpp"

namespace softffd {

namespace {

Vec3 applied(const Eigen::Matrix<double, 3, 4>& field, const Vec3& x) { return field.leftCols<3>() * x + field.col(3); }

/// Returns the obstacle that the body touches, a box as the half-space of its face there. Returns nothing if the body touches several
/// obstacles, or one that is free or round.
std::optional<Plane> only_face(const Drive& around, double t, const Points& x, const Samples* samples, double length) {
  std::optional<Plane> face;
  for (const Plane& each : around.planes) {
    const SolidPose pose = each.pose_at(t);
    const HalfSpace flat = each.at(t);
    for (int k = 0; k < (samples ? samples->count() : int(x.rows())); ++k) {
      const Vec3 place = samples ? samples->at(k, x) : Vec3(row(x, k));
      const HalfSpace here = each.solid() ? tangent(each, pose, place) : flat;
      if (here.gap(place) > touching * length) continue;
      if (face || each.own || (each.solid() && !each.box())) return std::nullopt;
      face = each;
      if (each.solid()) face->facing = pose.edges.transpose() * here.normal;
      break;
    }
  }
  return face;
}

/// The smallest rotation that takes the unit vector `from` to `to`, and its derivative for to' = `rate` [1/s].
struct Tilt {
  Eigen::Matrix3d turn, rate;
};

Tilt tilt(const Vec3& from, const Vec3& to, const Vec3& rate) {
  const auto cross = [](const Vec3& w) {
    Eigen::Matrix3d matrix;
    matrix << 0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0;
    return matrix;
  };
  const Eigen::Matrix3d w = cross(from.cross(to)), w_rate = cross(from.cross(rate));
  const double scale = 1 / (1 + from.dot(to)), scale_rate = -scale * scale * from.dot(rate);
  return {Eigen::Matrix3d::Identity() + w + scale * w * w, w_rate + scale_rate * w * w + scale * (w_rate * w + w * w_rate)};
}

}  // namespace

Carried::Carried(const Drive& around, double t, const Points& x, const Samples* samples, double length)
    : around_(around), t_(t), x_(x), by_pins_(std::ranges::any_of(around.pins, [](const Pin& pin) { return !pin.own && pin.bends(); })) {
  if (around.held() || std::ranges::none_of(around.planes, &Plane::bends)) return;
  face_ = only_face(around, t, x, samples, length);
  if (face_ && !face_->bends()) face_.reset();
  middle_ = x.colwise().mean();
}

void Carried::rates(double time, const Points& x, const Points& v) {
  const Motion now = at(time);
  const Field wind = now.wind();
  const Eigen::Matrix3d back = now.place.leftCols<3>().inverse();
  rate_.resize(x.rows(), 3);
  for (int p = 0; p < x.rows(); ++p) set_row(rate_, p, back * (row(v, p) - applied(wind, row(x, p))));
}

const Points& Carried::open(double time, double rest, double h, Points& start) {
  const Motion now = at(time);
  const Field wind = now.wind();
  ahead_.resize(x_.rows(), 3);
  for (int p = 0; p < x_.rows(); ++p) {
    const Vec3 rate = row(rate_, p), from = row(x_, p) + rest * rate;
    const Vec3 with = applied(wind, applied(now.place, from + h * rate));
    set_row(start, p, applied(now.place, from) - h * with);
    set_row(ahead_, p, with + now.place.leftCols<3>() * rate);
  }
  around_.visit_pinned(time, [&](const PinnedPoint& at) {
    if (!around_.pins[at.pin].own) set_row(start, at.point, at.place() - h * at.velocity());
  });
  return ahead_;
}

/// Returns A' A^-1.
Carried::Field Carried::Motion::wind() const {
  Field wind;
  wind.leftCols<3>() = velocity.leftCols<3>() * place.leftCols<3>().inverse();
  wind.col(3) = velocity.col(3) - wind.leftCols<3>() * place.col(3);
  return wind;
}

Carried::Motion Carried::at(double time) const { return face_ ? of_face(time) : of_pins(time); }

Carried::Motion Carried::of_pins(double time) const {
  Motion sum{Field::Zero(), Field::Zero()};
  double points = 0;
  for (const Pin& pin : around_.pins) {
    if (pin.own) continue;
    const Frame begin = pin.at(t_), now = pin.at(time);
    Motion each;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 arm = now.arm(begin.local(Vec3::Unit(axis)));
      each.place.col(axis) = arm;
      each.velocity.col(axis) = now.material_velocity(arm) - now.velocity;
    }
    each.place.col(3) = now.origin - each.place.leftCols<3>() * begin.origin;
    each.velocity.col(3) = now.velocity - each.velocity.leftCols<3>() * begin.origin;
    const double count = double(pin.points.size());
    sum.place += count * each.place;
    sum.velocity += count * each.velocity;
    points += count;
  }
  return {sum.place / points, sum.velocity / points};
}

/// The space turns with the normal by the smallest rotation, about the middle of the body, and moves along the normal so that the gap of
/// the middle stays the same. What the obstacle's material does along the face does not count.
Carried::Motion Carried::of_face(double time) const {
  const HalfSpace begin = face_->at(t_), now = face_->at(time);
  const Vec3 normal_rate = now.spin.cross(now.normal);
  const double gap = now.gap(middle_) - begin.gap(middle_);
  const double gap_rate = normal_rate.dot(middle_ - now.point) - now.normal.dot(now.velocity);
  const auto [turn, rate] = tilt(begin.normal, now.normal, normal_rate);
  Motion motion;
  motion.place << turn, middle_ - gap * now.normal - turn * middle_;
  motion.velocity << rate, -gap_rate * now.normal - gap * normal_rate - rate * middle_;
  return motion;
}

}  // namespace softffd
