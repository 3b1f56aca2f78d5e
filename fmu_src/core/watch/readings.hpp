/// What can be read of a soft body after a communication step: reactions, energies, and what is worth a warning. A view: it changes nothing
/// and is valid until the body changes.
#pragma once
#include "body/model.hpp"
#include "forces/cells.hpp"
#include "model/drive.hpp"
#include "watch/energy_watch.hpp"
#include "watch/vibration.hpp"

namespace softffd {

/// Step in units of the largest stable one above which friction can feed the vibrations of an undamped body [1]: up to it none has been
/// seen to.
inline constexpr double rubbing = 0.3;

struct Readings {
  const Model& model;
  const Drive& drive;
  const Cells& cells;
  const Run &now, &before;  ///< after and before the last communication step
  Vec3 gravity;             ///< [m/s2]
  double given_step;        ///< internal step that the user gives [s]; 0: none
  bool moved;               ///< pins or planes moved points at once when the last communication step began

  Vec3 plane_reaction(int q) const { return now.physical.exchange.planes[q].force / now.exchange_time; }
  Vec3 plane_torque(int q) const { return now.physical.exchange.planes[q].torque / now.exchange_time; }
  const Vec3& plane_centre(int q) const { return now.centres[q]; }
  Count plane_contacts(int q) const { return now.contacts[q]; }
  const PointReading& followed(int n) const { return now.physical.exchange.points[n]; }
  const SensorReading& sensor(int n) const { return now.sensors[n]; }
  /// Force on a taxel, by its number among those of all sensors [N].
  Vec3 taxel(int n) const {
    std::size_t of = 0;
    for (; n >= now.sensors[of].taxels.rows(); ++of) n -= int(now.sensors[of].taxels.rows());
    return row(now.sensors[of].taxels, n);
  }
  Vec3 pin_reaction(int a) const { return now.physical.exchange.pins[a].force / now.exchange_time; }
  Vec3 pin_torque(int a) const { return now.physical.exchange.pins[a].torque / now.exchange_time; }

  /// How far pin a, and obstacle q, moved a control point at once when the last communication step began [m].
  double pin_jump(int a) const;
  double plane_jump(int q) const;

  double kinetic_energy() const;
  double elastic_energy() const { return model.body.elastic_energy(now.physical.motion.x); }
  double gravity_energy() const;
  double dissipated_energy() const { return now.dissipated; }
  /// Of the outside: what free bodies gave the object, or took, is none of it.
  double work() const { return now.work + free_energy() - now.free_energy; }
  /// Kinetic and potential energy of free bodies [J].
  double free_energy() const;

  Count steps() const { return now.physical.steps; }
  Count rejected() const { return now.control.rejected; }
  /// What landings have made of errors by now [m].
  double landing_error() const { return now.control.neighbour.off.at(now.physical.motion.time, model.longest_lasting()); }
  /// The same, and what explicit steps through contact, and what follows from impacts, may have the result err by at the end of the run, so
  /// far [m].
  double stated_error() const {
    return hypotenuse(landing_error() + now.physical.error.largest(), now.physical.damped_error + now.physical.damped_fading);
  }
  Count contacts_resolved() const { return now.contacts_resolved; }
  /// The method that took the last communication step, and why.
  Method method() const { return now.control.method; }
  Reason reason() const { return now.control.reason; }
  /// Internal step of the last communication step [s].
  double internal_step() const { return now.physical.clock.h; }
  /// Largest stable internal step of the current state, by bound [s]; the largest finite number if nothing resists.
  double stable_step() const { return model.stability.stable_step(model.body, now.physical.motion.x); }
  /// Number of cells with a corner that is turned inside out or flat.
  int folded_cells() const;

  bool damped() const { return model.body.damped; }
  /// Has the body more energy than it was given?
  bool gains_energy() const { return alarm(now.energy, model.noise); }
  double gained_energy() const { return now.energy.gained; }  ///< out of nothing [J]
  /// What an undamped body should have more [J]: lost by the method. Below 0: gained.
  double lost_energy() const;
  double largest_energy() const { return now.energy.largest; }  ///< kinetic and elastic, so far [J]
  /// Factor of the usual internal step that automatic steps take since the usual one gained energy.
  double step_factor() const { return now.energy.step_factor; }
  bool beyond_help() const { return now.energy.hopeless; }  ///< and smaller automatic steps do not help
  /// Did an undamped body rub against an obstacle in the last communication step, at given steps by which friction can feed vibrations?
  bool rubs_undamped() const;
  /// How fast the body turned before or after the last communication step, whichever is faster, if implicit contact steps took it; they
  /// damp that. Otherwise 0 [rad/s].
  double damped_spin() const;
  /// Do springs have no length and would push their ends apart, if rounding gave them a direction? Where nothing moves at all, nothing is
  /// to be decided.
  bool undecided() const;

  /// Size of vibrations of this energy [J], of a time scale up to this [s], in all of the body [m].
  double amplitude(double energy, double slowest) const { return softffd::amplitude(model, energy, slowest); }
  /// The vibration that the start of the last communication step set off by jumps of the forces and by `kink`, the fraction of the change
  /// of velocity that came at once; any that was there, if the step before was explicit.
  Vibration set_off(double kink, Points& scratch, Points& more) const;
  /// Fraction of a vibration of frequency omega [rad/s] that the slowest damping leaves after a time t [s]. What dashpots let creep no
  /// longer vibrates: that is in no phase to be lost.
  double remaining(double t, double omega) const;
};

}  // namespace softffd
