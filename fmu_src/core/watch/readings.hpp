/// What can be read from a soft body after a communication step: reactions, energies, and what is worth a warning. A view: it changes
/// nothing and is valid until the body changes.
#pragma once
#include "body/model.hpp"
#include "forces/cells.hpp"
#include "model/drive.hpp"
#include "watch/energy_watch.hpp"
#include "watch/vibration.hpp"

namespace softffd {

/// Above this step, in units of the largest stable one, friction can feed the vibrations of an undamped body [1]; at smaller steps it has
/// not been seen to.
inline constexpr double rubbing = 0.3;

struct Readings {
  const Model& model;
  const Drive& drive;
  const Cells& cells;
  const Run &now, &before;  ///< after and before the last communication step
  Vec3 gravity;             ///< [m/s2]
  double given_step;        ///< internal step that the user gives [s]; 0: none
  bool moved;               ///< pins or planes displaced points at once when the last communication step began

  Vec3 plane_reaction(int q) const { return now.plane_reactions[q].force; }
  Vec3 plane_torque(int q) const { return now.plane_reactions[q].torque; }
  const Vec3& plane_centre(int q) const { return now.centres[q]; }
  Count plane_contacts(int q) const { return now.contacts[q]; }
  const PointReading& followed(int n) const { return now.physical.exchange.points[n]; }
  const SensorReading& sensor(int n) const { return now.sensors[n]; }
  /// Returns the force on a taxel, by its number among the taxels of all sensors [N].
  Vec3 taxel(int n) const {
    std::size_t of = 0;
    for (; n >= now.sensors[of].taxels.rows(); ++of) n -= int(now.sensors[of].taxels.rows());
    return row(now.sensors[of].taxels, n);
  }
  Vec3 pin_reaction(int a) const { return now.pin_reactions[a].force; }
  Vec3 pin_torque(int a) const { return now.pin_reactions[a].torque; }

  /// Return how far pin a, or obstacle q, displaced points at once when the last communication step began [m].
  double pin_jump(int a) const;
  double plane_jump(int q) const;

  double kinetic_energy() const;
  double elastic_energy() const { return model.body.elastic_energy(now.physical.motion.x); }
  double gravity_energy() const;
  double dissipated_energy() const { return now.dissipated; }
  /// Returns the work of the outside [J], without the energy that free bodies gave the object or took from it.
  double work() const { return now.work + free_energy() - now.free_energy; }
  /// Returns the kinetic and potential energy of free bodies [J].
  double free_energy() const;

  Count steps() const { return now.physical.steps; }
  Count rejected() const { return now.control.rejected; }
  /// Returns the error that landings have made of earlier errors by now [m].
  double landing_error() const { return now.control.neighbour.off.at(now.physical.motion.time, model.longest_lasting()); }
  /// Returns what rounding may have become by the end of the run while the body tumbles [m].
  double tumbling_error() const { return now.control.tumbling.error; }
  /// Returns the final error so far [m]: the landing error, that of tumbling, and the errors from explicit steps through contact, from the
  /// consequences of impacts, and from implicit steps of damped bodies.
  double stated_error() const {
    return hypotenuse(landing_error() + now.physical.error.largest(), now.physical.damped_error + now.physical.damped_fading) +
           tumbling_error();
  }
  Count contacts_resolved() const { return now.contacts_resolved; }
  /// The method that took the last communication step, and why.
  Method method() const { return now.control.method; }
  Reason reason() const { return now.control.reason; }
  /// Internal step of the last communication step [s].
  double internal_step() const { return now.physical.clock.h; }
  /// Largest stable internal step of the current state, by bound [s]; the largest finite number if nothing resists.
  double stable_step() const { return model.stability.stable_step(model.body, now.physical.motion.x); }
  /// Returns the number of inverted cells: those with a corner that is turned inside out or flat.
  int folded_cells() const;

  bool damped() const { return model.body.damped; }
  /// True if the body has more energy than it was given.
  bool gains_energy() const { return alarm(now.energy, model.noise); }
  double gained_energy() const { return now.energy.gained; }  ///< energy gained out of nothing [J]
  /// Returns the energy of an undamped body that the method has lost [J]; negative if gained.
  double lost_energy() const;
  double largest_energy() const { return now.energy.largest; }  ///< kinetic and elastic, so far [J]
  /// Returns the factor of the usual internal step that automatic steps take since the usual step gained energy.
  double step_factor() const { return now.energy.step_factor; }
  bool beyond_help() const { return now.energy.hopeless; }  ///< smaller automatic steps did not help
  /// True if an undamped body rubbed on an obstacle in the last communication step, at given steps by which friction can feed vibrations.
  bool rubs_undamped() const;
  /// Returns the spin of the body before or after the last communication step, whichever is larger [rad/s], if backward Euler was asked
  /// for and took it; its steps damp the rotation. Otherwise 0.
  double damped_spin() const;
  /// True if springs of length zero would push their ends apart if rounding gave them a direction. False if all spring forces are zero:
  /// where nothing moves, nothing has to be decided.
  bool undecided() const;

  /// Returns the size of vibrations of this energy [J] with time scales up to `slowest` [s], spread over the body [m].
  double amplitude(double energy, double slowest) const { return softffd::amplitude(model, energy, slowest); }
  /// Returns the vibration that the start of the last communication step set off, by jumps of the forces and by `kink`, the fraction of
  /// the change of velocity that came at once; if the step before was explicit, also a vibration that was there already.
  Vibration set_off(double kink, Points& scratch, Points& more) const;
  /// Returns the fraction of a vibration of frequency omega [rad/s] that the slowest damping leaves after a time t [s]. Motion that creeps
  /// by dashpots no longer vibrates, and has no phase to be lost.
  double remaining(double t, double omega) const;
};

}  // namespace softffd
