#include "contact/reactions.hpp"

#include <algorithm>

#include "contact/tolerances.hpp"

namespace softffd {

Reactions::Reactions(int points, int planes) : trial_(points, planes), rested_(points) {
  nowhere_.planes.resize(planes);
  for (Points* each : {&forces_, &free_, &held_, &x_}) each->setZero(points, 3);
}

void Reactions::clear() { forces_.setZero(); }

void Reactions::kick(const StepView& step, const Points& v0) {
  const Body& body = step.body;
  for (int axis = 0; axis < 3; ++axis)
    free_.col(axis) =
        v0.col(axis) + (0.5 * step.h) * (step.spring.col(axis) + step.force.col(axis) - body.damping * v0.col(axis)) / body.mass;
  held_ = free_;
}

/// Computes the forces on all points that the contact rule has corrected.
void Reactions::find(const StepView& step) {
  forces_.setZero();
  for (const int p : trial_.points())
    if (!step.body.pinned[p]) set_row(forces_, p, step.body.mass[p] * (row(held_, p) - row(free_, p)) / (0.5 * step.h));
}

void Reactions::open(const StepView& step, const Points& v0) {
  kick(step, v0);
  x_ = step.x0 + step.h * held_;
  std::fill(rested_.begin(), rested_.end(), 0);
  trial_.begin(step.around, step.t0, step.h);
  trial_.find(step, x_);
  if (trial_.drift(step, v0, held_, x_, nowhere_) != StepStatus::ok) return clear();
  find(step);
  for (const int p : trial_.points()) {  // points that land in this step have no reaction yet
    const bool rests = std::any_of(step.around.planes.begin(), step.around.planes.end(), [&](const Plane& plane) {
      return plane.at(step.t0).gap(row(step.x0, p)) <= touching * step.body.length;
    });
    if (!rests) set_row(forces_, p, Vec3::Zero());
    rested_[p] = rests;
  }
}

void Reactions::close(const StepView& step, const Contact& contact, const Points& v0) {
  trial_ = contact;
  kick(step, v0);
  if (trial_.close(step, held_, nowhere_) != StepStatus::ok) return clear();
  find(step);
  for (const int p : trial_.points())
    if (!rested_[p]) set_row(forces_, p, Vec3::Zero());
}

/// A point that a pin holds too gets no force here: the reaction is the pin's, and in the kick the force would count as lost.
void Reactions::hold(const StepView& step, SurfaceContact& surface, const PhysicalState& physical, const Points& v0) {
  kick(step, v0);
  if (surface.hold(step, held_, physical.surface, physical.motion.free) != StepStatus::ok) return clear();
  for (int axis = 0; axis < 3; ++axis) forces_.col(axis) = step.body.mass * (held_.col(axis) - free_.col(axis)) / (0.5 * step.h);
  for (int p = 0; p < step.body.points(); ++p)
    if (step.body.pinned[p]) set_row(forces_, p, Vec3::Zero());
}

void Reactions::give_back(const StepView& step, Points& v) const {
  for (int axis = 0; axis < 3; ++axis) v.col(axis) -= (0.5 * step.h) * forces_.col(axis) / step.body.mass;
}

}  // namespace softffd
