/// Free flight of a stiff body over any length of time at once, by modal superposition in a floating frame: the rigid motion
/// (rigid_body.hpp), and the vibrations, each with its phase, in a frame that turns with the rest shape (modes.hpp).
///
///      x = c + Q (r + u),   u = sum of shape_a q_a,   Q: the rotation closest to the body's deformation, c: its centre of mass.
///
/// A mode vibrates about the static deformation s_a = (Q^T (f - inertia of the frame's motion), shape_a) / omega_a^2 under the loads in
/// the frame: q = s + Re z, q' = -omega Im z, where z turns as exp(i omega t - decay t). Modes of neighbouring frequencies turn together
/// in a group, coupled by Coriolis' force. The rigid motion is that of the rest shape, with the mean angular momentum of the vibrations
/// inside. Entering and leaving the frame conserves momentum and angular momentum to rounding.
///
/// Neglected are the change of frequencies with the amplitude (`neglected_rate`), the coupling of a mode to others and to the rigid motion
/// by unequal damping (`neglected_way`), and the turning of loads within a vibration, which is slight where `energy_missed` is.
#pragma once
#include "flight/modes.hpp"
#include "flight/rigid_body.hpp"
#include "model/state.hpp"

namespace softffd {

class ModalFlight {
 public:
  explicit ModalFlight(const Lattice& lattice);

  /// True if this body has modes for such a flight. Computes the modes if the material has changed.
  bool possible(const Body& body);
  const Modes& modes() const { return modes_; }

  /// Decomposes the motion at time t [s] into rigid motion and modes. Energies are those of vibration and deformation at that time.
  void enter(const Equations& equations, double t, const State& state);
  double energy() const;          ///< energy of the modes [J]
  double energy_missed() const;   ///< by how much the energy of the modes differs from the body's [J]
  double mean_frequency() const;  ///< root of the mean of omega^2, weighted by energy [rad/s]
  /// Returns the energy of the modes after damping has acted for `time` [s] [J].
  double energy_after(double time) const;
  /// Returns the speed at which points move off because the frequencies' change with the amplitude is neglected [m/s].
  double neglected_rate() const;
  /// Returns how far unequal damping, as far as it is neglected, may move a point [m]: by the coupling between modes, and by the drag of
  /// displacements on the rigid motion for the time `until` [s], after which an error is forgotten or the run ends.
  double neglected_way(const Equations& equations, double until);
  /// Returns the time constant of the slowest damping [s]; infinite without damping.
  double memory() const;
  /// Returns the fraction of an amplitude that the slowest damping leaves after `time` [s].
  double remaining(double time) const;
  /// Returns the present rigid part of the motion.
  const RigidState& rigid() const { return rigid_; }

  /// Advances the rigid motion until a point could touch an obstacle, at most `most` [s], with all modes at their amplitude (still:
  /// without modes). No point can cross the gap in one advance, and the last one is below `shortest` [s]. Returns the elapsed time [s].
  double until_touch(const Equations& equations, double most, double shortest, bool still);
  /// Composes the motion at the time that `until_touch` has reached.
  void leave(const Equations& equations, State& state);

  /// Stores the vibration of the last `enter` for `difference`.
  void remember();
  /// Returns the size of the difference between the vibration and the stored one, |(q', omega q)| / sqrt(mass) [m/s].
  double difference() const;

 private:
  void load(const Equations& equations, double t, Eigen::VectorXd& held);
  void vibrate(double time);
  void turn_group(int first, int count, double time, const Vec3& spin);
  Vec3 inner_momentum(double spin) const;
  double pulled_on(const Body& body, const Eigen::VectorXd& amplitudes);
  /// The least gap between an obstacle and the body [m], and bounds of the speed and the acceleration at which it closes [m/s, m/s2].
  struct Nearing {
    double gap, speed, acceleration;
  };
  Nearing nearing(const Body& body, const Plane& plane, bool still);
  Nearing nearing_solid(const Body& body, const Plane& solid, bool still, double time) const;
  Nearing nearing_free(const Plane& free, const Plane& other, double time) const;
  double least_gap(const Body& body, const HalfSpace& obstacle, bool still);

  Points rest_;
  double cell_;  ///< shortest side of a cell [m]
  Modes modes_;
  Count version_ = -1;  ///< of the body that the modes belong to
  RigidBody body_;
  RigidState begin_, rigid_;
  double t0_ = 0, t_ = 0;                            ///< times of `enter` and of the present rigid motion [s]
  double deformation_ = 0;                           ///< the body's energy of vibration and deformation [J]
  Eigen::Matrix3d attitude_;                         ///< Q at `enter`
  Vec3 spin_;                                        ///< mean spin of the rigid motion, in body axes [rad/s]
  Eigen::VectorXd q_, q_rate_, held_;                ///< (modes) modal coordinates q, q' and static deformations s
  Eigen::VectorXd old_, old_rate_;                   ///< the stored vibration
  Eigen::VectorXd displacement_, rate_, amplitude_;  ///< workspace
  Scalars way_;                                      ///< (points) largest excursion of each point [m]
  Scalars heights_;                                  ///< (points) workspace
  Points x_, v_, outside_;
};

}  // namespace softffd
