#include "impacts/contact_events.hpp"

#include <algorithm>
#include <cmath>

#include "body/rigid_motion.hpp"
#include "kit/outlook.hpp"

namespace softffd {

ContactEvent event_of(const StepContext& context, const Slip& slip, double pressing, const PhysicalState& from, double slight) {
  const State& motion = context.run.physical.motion;
  const double h = motion.time - from.motion.time;
  if (!context.drive.pins.empty() || (slip.stopped == 0 && !context.drive.ramped)) return {};
  const Outlook ahead = outlook_of_stiff(context, motion);
  const double along = std::max(ahead.along_plane, h);
  ContactEvent event{0, slip.load > 0 ? 2 * slip.stopped / slip.load * along : 0};
  if (!context.drive.ramped) return event;
  Vec3 rate = Vec3::Zero();  // time derivative of the total outside force [N/s]
  for (int axis = 0; axis < 3; ++axis)
    for (int p = 0; p < motion.x.rows(); ++p) {
      const Eigen::Index i = p + axis * motion.x.rows();
      rate[axis] += (context.drive.ramp(i, motion.time) - context.drive.ramp(i, from.motion.time)) / h;
    }
  const double mass = context.model.body.mass.sum();
  const auto consider = [&](double grows, double spare, double speed, double length) {  // [N/s], [N], [m/s], [s]
    if (!(grows > 0)) return;
    const double when = spare > 0 ? 0.5 * h + spare / grows : 0.5 * h - speed * mass / (grows * h);
    if (!(when > 0 && when < h)) return;
    const double wrong = spare > 0 ? h - when : when, error = 0.5 * grows / mass * wrong * wrong * length;
    if (error > event.error) event = {when, error};
  };
  const double rubs = slip.friction.norm();
  if (slip.load > 0 && rubs > 0 && slip.before * along <= slight * slip.load) {
    const double coefficient = (slip.spare + rubs) / slip.load;
    const double grows = coefficient * rate.dot(ahead.normal) - rate.dot(slip.friction) / rubs;
    consider(grows, slip.loosened > 0 ? 0 : slip.spare, slip.loosened / slip.load, along);
  }
  const Body& body = context.model.body;
  const RigidMotion begin = rigid_motion(body.mass, from.motion.x, from.motion.v), end = rigid_motion(body.mass, motion.x, motion.v);
  if (from.stiff.pressing > 0)
    consider(rate.dot(ahead.normal), pressing, (end.velocity - begin.velocity).dot(ahead.normal), std::max(ahead.along_normal, h));
  const HalfSpace obstacle = nearest_obstacle(context, motion).obstacle;
  const double radius = radius_about(end.centre, motion.x);
  const auto speed = [&](const RigidMotion& rigid) {
    return (rigid.velocity - obstacle.material_velocity(rigid.centre)).norm() + radius * (rigid.spin - obstacle.spin).norm();
  };
  if (speed(begin) * along <= slight && speed(end) * along > slight) consider(rate.norm(), 0, speed(end), along);  // begins to move
  return event;
}

}  // namespace softffd
