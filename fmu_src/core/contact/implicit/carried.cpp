#include "contact/implicit/carried.hpp"

#include <algorithm>

namespace softffd {

Carried::Carried(const Drive& around, double t, const Points& x)
    : around_(around), t_(t), x_(x), bends_(std::ranges::any_of(around.pins, [](const Pin& pin) { return !pin.own && pin.bends(); })) {}

void Carried::place(double rest, double h, Points& start) const {
  if (!bends_) return;
  const double end = t_ + rest + h;
  add(way(end) - rest * velocity(t_ + h) - h * velocity(end), start);
  around_.visit_pinned(end, [&](const PinnedPoint& at) {
    if (!around_.pins[at.pin].own) set_row(start, at.point, at.place() - h * at.velocity());
  });
}

const Points& Carried::ahead(const Points& v, double from, double to) {
  if (!bends_) return v;
  ahead_ = v;
  add(velocity(to) - velocity(from), ahead_);
  return ahead_;
}

/// Mean over the pins of a field of each, which `of` gives at the end of an arm of the pin's frame at the start.
template <class Of>
Carried::Field Carried::mean(Of of) const {
  Field sum = Field::Zero();
  double points = 0;
  for (const Pin& pin : around_.pins) {
    if (pin.own) continue;
    const Frame begin = pin.at(t_);
    const Vec3 at_origin = of(pin, begin, Vec3::Zero());
    Field field;
    for (int axis = 0; axis < 3; ++axis) field.col(axis) = of(pin, begin, Vec3::Unit(axis)) - at_origin;
    field.col(3) = at_origin - field.leftCols<3>() * begin.origin;
    sum += double(pin.points.size()) * field;
    points += double(pin.points.size());
  }
  return sum / points;
}

/// Displacement from the start to `time` [m].
Carried::Field Carried::way(double time) const {
  return mean([&](const Pin& pin, const Frame& begin, const Vec3& arm) -> Vec3 {
    const Frame end = pin.at(time);
    return end.origin + end.arm(begin.local(arm)) - (begin.origin + arm);
  });
}

Carried::Field Carried::velocity(double time) const {
  return mean([&](const Pin& pin, const Frame& begin, const Vec3& arm) {
    const Frame then = pin.at(time);
    return then.material_velocity(then.arm(begin.local(arm)));
  });
}

void Carried::add(const Field& field, Points& y) const {
  for (int p = 0; p < y.rows(); ++p) set_row(y, p, row(y, p) + field.leftCols<3>() * row(x_, p) + field.col(3));
}

}  // namespace softffd
