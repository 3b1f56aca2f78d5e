#include <algorithm>
#include <cassert>
#include <cmath>

#include "contact/implicit/contact_set.hpp"

namespace softffd {

namespace {

/// The elastic part of friction is this much stiffer than the stiffest spring [1], but its slip is at least this fraction of the box.
constexpr double stiffer_than_springs = 1e5, shortest_reach = 1e-9;
/// Factor, up or down, by which the largest friction may leave the scale that its stiffness is made for, before a new scale is adopted.
constexpr double scale_room = 4;
/// Relative change of friction's stiffness above which the matrix is made anew.
constexpr double stiffness_change = 0.5;

}  // namespace

bool ContactSet::scale_friction(double length, double largest_stiffness) {
  double largest = 0;
  for (int p : touching_)
    for (int i = 0; i < at_[p].count; ++i) largest = std::max(largest, friction_[at_[p].touches[i].plane] * at_[p].touches[i].load);
  if (largest == 0 || (largest <= scale_room * load_scale_ && largest >= load_scale_ / scale_room)) return false;
  load_scale_ = largest;
  reach_ = std::max(shortest_reach * length, largest_stiffness > 0 ? largest / (stiffer_than_springs * largest_stiffness) : 0.0);
  return true;
}

/// Tangential motion of the point relative to the plane's material in this step, plus the elastic slip at its start [m].
Vec3 ContactSet::slip(const Touch& touch, const Vec3& x0, const Vec3& moved, double h) const {
  const Vec3 slip = tangential(touch.normal, moved - h * material_velocity(touch.plane, x0 + seen_at_ * moved));
  return load_scale_ > 0 ? Vec3(slip - reach_ / load_scale_ * touch.held) : slip;
}

void ContactSet::hold_or_slide(Touch& touch, const Vec3& slip) {
  touch.fresh = false;
  touch.used = std::max(0.0, touch.load);
  const double limit = friction_[touch.plane] * touch.used, size = slip.norm(), held = load_scale_ / reach_;
  touch.slip = slip;
  touch.sticks = held * size <= limit;
  touch.wanted = limit == 0 ? 0 : touch.sticks ? held : limit / size;
  touch.friction = -touch.wanted * slip;
}

bool ContactSet::find_friction(const Points& x0, const Points& u, double h, double slight) {
  bool changed = false;
  for (int p : touching_)
    for (int i = 0; i < at_[p].count; ++i) {
      Touch& touch = at_[p].touches[i];
      hold_or_slide(touch, slip(touch, row(x0, p), row(u, p), h));
      changed = left(touch, slight) || changed;
    }
  return changed;
}

/// True if the stiffness of friction differs too much from that in the matrix.
bool ContactSet::left(const Touch& touch, double slight) {
  const double more = std::abs(touch.wanted - touch.stiffness);
  const bool turned = touch.wanted > slight && touch.stiffness > 0 && touch.sticks != touch.direction.isZero(0);
  return turned || (more > slight && more > stiffness_change * touch.stiffness);
}

bool ContactSet::take_friction_stiffness(double slight) {
  std::size_t count = 0;
  for (int p : touching_) count += at_[p].count;
  if (count != in_matrix_.size()) return false;
  bool same = true;
  for (const InMatrix& each : in_matrix_) {
    AtPoint& at = at_[each.point];
    const auto touch = std::find_if(at.touches.begin(), at.touches.begin() + at.count,
                                    [&](const Touch& here) { return here.plane == each.touch.plane && here.normal == each.touch.normal; });
    if (touch == at.touches.begin() + at.count) return false;
    touch->stiffness = each.touch.stiffness;
    touch->direction = each.touch.direction;
    same = same && !left(*touch, slight);
  }
  return same;
}

void ContactSet::find_new_friction(const Points& x0, const Points& u, double h) {
  for (int p : touching_)
    for (int i = 0; i < at_[p].count; ++i)
      if (at_[p].touches[i].fresh) hold_or_slide(at_[p].touches[i], slip(at_[p].touches[i], row(x0, p), row(u, p), h));
}

void ContactSet::guess_friction(const Points& x0, const Points& u, const Points& free, double h) {
  for (int p : touching_)
    for (int i = 0; i < at_[p].count; ++i) {
      Touch& touch = at_[p].touches[i];
      hold_or_slide(touch, slip(touch, row(x0, p), row(free, p), h));
      if (!touch.sticks) continue;
      touch.slip = slip(touch, row(x0, p), row(u, p), h);
      touch.friction = -touch.wanted * touch.slip;
    }
}

void ContactSet::fix_friction_stiffness(bool cautious) {
  for (int p : touching_)
    for (int i = 0; i < at_[p].count; ++i) {
      Touch& touch = at_[p].touches[i];
      assert(!touch.fresh);
      touch.stiffness = touch.wanted;
      touch.direction = cautious || touch.sticks || touch.wanted == 0 ? Vec3::Zero() : Vec3(touch.slip / touch.slip.norm());
    }
}

bool ContactSet::stop_reversals(const Points& dx) {
  bool any = false;
  for (int p : touching_)
    for (int i = 0; i < at_[p].count; ++i) {
      Touch& touch = at_[p].touches[i];
      if (touch.sticks || touch.wanted == 0 || touch.slip.dot(touch.slip + row(dx, p)) > 0) continue;
      touch.sticks = true;
      touch.wanted = load_scale_ / reach_;
      touch.friction = -touch.wanted * touch.slip;
      any = true;
    }
  return any;
}

void ContactSet::hold(Holds& holds) const {
  if (holds.size() < end_.size()) holds.assign(end_.size(), Points(at_.size(), 3));
  for (Points& forces : holds) forces.setZero();
  for (int p : touching_)
    for (int i = 0; i < at_[p].count; ++i) set_row(holds[at_[p].touches[i].plane], p, at_[p].touches[i].friction);
}

Vec3 ContactSet::linear_friction(const Touch& touch, const Vec3& dx) {
  const Vec3 along = tangential(touch.normal, dx);
  return touch.friction - touch.stiffness * (along - touch.direction.dot(along) * touch.direction);
}

Eigen::Matrix3d ContactSet::friction_stiffness(int p) const {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (int i = 0; i < at_[p].count; ++i) {
    const Touch& touch = at_[p].touches[i];
    sum += touch.stiffness *
           (Eigen::Matrix3d::Identity() - touch.normal * touch.normal.transpose() - touch.direction * touch.direction.transpose());
  }
  return sum;
}

bool ContactSet::slides(const Touch& touch) const { return !touch.sticks && friction_[touch.plane] > 0; }

int ContactSet::sliding() const {
  int count = 0;
  for (int p : touching_)
    for (int i = 0; i < at_[p].count; ++i) count += slides(at_[p].touches[i]);
  return count;
}

void ContactSet::lacking_loads(Scalars& lack) const {
  int n = 0;
  for (int p : touching_)
    for (int i = 0; i < at_[p].count; ++i) {
      const Touch& touch = at_[p].touches[i];
      if (slides(touch)) lack[n++] = touch.load - touch.used;
    }
}

void ContactSet::friction_of(const Scalars& loads, Points& force) const {
  force.setZero();
  int n = 0;
  for (int p : touching_)
    for (int i = 0; i < at_[p].count; ++i) {
      const Touch& touch = at_[p].touches[i];
      if (slides(touch)) set_row(force, p, row(force, p) - friction_[touch.plane] * loads[n++] / touch.slip.norm() * touch.slip);
    }
}

void ContactSet::loads_of(const Points& made, const Points& friction, const Points& dx, Scalars& loads) const {
  int n = 0;
  for (int p : touching_) {
    const AtPoint& at = at_[p];
    Vec3 normal_force = row(made, p) - row(friction, p);
    for (int i = 0; i < at.count; ++i) normal_force -= linear_friction(at.touches[i], row(dx, p)) - at.touches[i].friction;
    const Vec3 all = at.gram_inverse * (normals(at).transpose() * normal_force);
    for (int i = 0; i < at.count; ++i)
      if (slides(at.touches[i])) loads[n++] = all[i];
  }
}

void ContactSet::use_loads(const Scalars& more) {
  int n = 0;
  for (int p : touching_)
    for (int i = 0; i < at_[p].count; ++i) {
      Touch& touch = at_[p].touches[i];
      if (!slides(touch)) continue;
      touch.friction -= friction_[touch.plane] * more[n] / touch.slip.norm() * touch.slip;
      touch.used += more[n++];
    }
}

}  // namespace softffd
