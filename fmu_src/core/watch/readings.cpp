#include "watch/readings.hpp"

#include <algorithm>

#include "body/rigid_motion.hpp"
#include "contact/surface/tangents.hpp"
#include "methods/traits.hpp"

namespace softffd {

double Readings::kinetic_energy() const {
  double energy = 0.5 * (model.body.mass * now.physical.motion.v.square().rowwise().sum()).sum();
  for (const FreeMotion& each : drive.free) energy += each.kinetic_energy(now.physical.motion.free[each.index()]);
  return energy;
}

double Readings::free_energy() const {
  double energy = 0;
  for (const FreeMotion& each : drive.free) {
    const FreeState& state = now.physical.motion.free[each.index()];
    energy += each.kinetic_energy(state) - each.own_mass() * gravity.dot(each.own(state).position);
  }
  return energy;
}

double Readings::gravity_energy() const {
  double energy = 0;
  for (int axis = 0; axis < 3; ++axis) energy -= gravity[axis] * (model.body.weight * now.physical.motion.x.col(axis)).sum();
  for (const FreeMotion& each : drive.free)
    energy -= each.own_mass() * gravity.dot(each.own(now.physical.motion.free[each.index()]).position);
  return energy;
}

int Readings::folded_cells() const {
  int folded = cells.folded(now.physical.motion.x);
  for (const auto& each : model.body.energies) folded = std::max(folded, each->folded_cells(now.physical.motion.x));
  return folded;
}

double Readings::lost_energy() const { return lost(now.energy, {model.body, drive}, now); }

bool Readings::rubs_undamped() const {
  if (model.body.damped || given_step == 0 || now.physical.exchange.contacts_resolved == 0) return false;
  const auto rubs = [](const Plane& plane) { return plane.friction > 0; };
  return std::any_of(drive.planes.begin(), drive.planes.end(), rubs) && internal_step() > rubbing * stable_step();
}

double Readings::pin_jump(int a) const {
  const Pin& pin = drive.pins[a];
  const Frame frame = pin.at(drive.since);
  double jump = 0;
  for (std::size_t n = 0; n < pin.points.size(); ++n)
    jump = std::max(jump, (frame.origin + frame.arm(pin.local[n]) - row(before.physical.motion.x, pin.points[n])).norm());
  return jump;
}

double Readings::plane_jump(int q) const {
  const SolidPose plane = drive.planes[q].pose_at(drive.since);
  double jump = 0;
  if (const Samples* samples = model.body.samples.get()) {
    for (int s = 0; s < samples->count(); ++s) {
      const Vec3 place = samples->at(s, before.physical.motion.x);
      const HalfSpace facing = drive.planes[q].solid() ? tangent(drive.planes[q], plane, place) : HalfSpace(plane);
      jump = std::max(jump, -facing.gap(place));
    }
    return jump;
  }
  for (int p = 0; p < model.body.points(); ++p)
    if (!model.body.pinned[p]) jump = std::max(jump, -plane.gap(row(before.physical.motion.x, p)));
  return jump;
}

double Readings::damped_spin() const {
  if (now.control.method != Method::backward_euler || now.control.reason != Reason::asked) return 0;
  const auto spin = [&](const State& state) { return rigid_motion(model.body.mass, state.x, state.v).spin.norm(); };
  return std::max(spin(before.physical.motion), spin(now.physical.motion));
}

bool Readings::undecided() const {
  const State& motion = now.physical.motion;
  if (motion.spring.isZero(0)) return false;
  const auto& energies = model.body.energies;
  return std::any_of(energies.begin(), energies.end(),
                     [&](const auto& each) { return each->undecided(motion.x, motion.v, model.body.pinned); });
}

Vibration Readings::set_off(double kink, Points& scratch, Points& more) const {
  const bool followed = passes_over_vibrations(before.control.method);
  const State& start = before.physical.motion;
  if (followed) {
    scratch = drive.force - *before.outside;
  } else {  // the forces less those that hold the body on its turn
    const RigidMotion rigid = rigid_motion(model.body.mass, start.x, start.v);
    scratch = drive.force + start.spring;
    for (int p = 0; p < model.body.points(); ++p) {
      const Vec3 arm = row(start.x, p) - rigid.centre;
      set_row(scratch, p, row(scratch, p) - model.body.mass[p] * rigid.spin.cross(rigid.spin.cross(arm)));
    }
  }
  return softffd::set_off({model.body, drive}, start, now.physical.motion, followed || drive.bent ? kink : 1, scratch, more);
}

double Readings::remaining(double t, double omega) const {
  const double along_springs = 0.5 * model.body.shortest_time() * omega * omega;
  const double rate = 0.5 * (model.body.damping / model.body.mass).minCoeff() + (model.body.dashpots() ? along_springs : 0.0);
  double growth = 1 + rate * t / 1024;  // exp without the C library, to the power of 1024
  for (int i = 0; i < 10; ++i) growth *= growth;
  return 1 / growth;
}

}  // namespace softffd
