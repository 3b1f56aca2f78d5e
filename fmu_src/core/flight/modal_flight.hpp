/// Free flight of a stiff body for any length of time at once: its rigid motion (rigid_body.hpp), and its vibrations, each with its phase,
/// in a frame that turns with the rest shape (modes.hpp).
///
///      x = c + Q (r + u),   u = sum of shape_a q_a,   Q: the rotation next to the body's, c: its centre of mass,
///
/// a mode going round the deformation s_a that the loads in the frame hold it at, (Q^T (f - inertia of the frame's motion), shape_a) /
/// omega_a^2:      q = s + Re z, q' = -omega Im z, and z turns as exp(i omega t - decay t), in groups of neighbouring frequencies with what
/// Coriolis' force couples. The rigid motion is that of the rest shape with the vibration's mean angular momentum inside. Going in and out
/// of the frame keeps momentum and angular momentum to rounding.
///
/// Left out: how frequencies change with amplitude (`neglected_rate`), what unequal damping makes of one mode in others and of the rigid
/// motion
/// (`neglected_way`), and how loads turn within a vibration, slight where `energy_missed` is.
#pragma once
#include "flight/modes.hpp"
#include "flight/rigid_body.hpp"
#include "model/state.hpp"

namespace softffd {

class ModalFlight {
 public:
  explicit ModalFlight(const Lattice& lattice);

  /// Whether this body has the modes for it; makes them where the material is new.
  bool possible(const Body& body);
  const Modes& modes() const { return modes_; }

  /// Takes the motion apart at time t. Energies are those of vibration and deformation there.
  void enter(const Equations& equations, double t, const State& state);
  double energy() const;          ///< of the modes [J]
  double energy_missed() const;   ///< what the modes do not have of the body's [J]
  double mean_frequency() const;  ///< root of the mean of omega^2, by energy [rad/s]
  /// The same after a time in which damping has had its share.
  double energy_after(double time) const;
  /// Rate at which the vibrations' change of frequency with their amplitude, which is left out, moves points [m/s].
  double neglected_rate() const;
  /// How far unequal damping may move a point by what it makes of one mode in others, and, until an error is forgotten or the run ends [s],
  /// by what it takes of the rigid motion for displacements, which is left out [m].
  double neglected_way(const Equations& equations, double until);
  /// Time in which the slowest damping forgets [s].
  double memory() const;
  /// Share of an amplitude that the slowest damping leaves.
  double remaining(double time) const;
  /// The rigid part of the motion now.
  const RigidState& rigid() const { return rigid_; }

  /// Goes on until a point could touch an obstacle, `most` [s] at most, the modes going as far as they can at the same moment (still: not
  /// at all), by steps that no point can cross the gap in, the last one below `shortest`. Returns the time gone [s].
  double until_touch(const Equations& equations, double most, double shortest, bool still);
  /// Puts the motion together as it is after until_touch.
  void leave(const Equations& equations, State& state);

  /// Keeps the vibration of the last `enter` to compare another with.
  void remember();
  /// Size of what the vibration differs by from the one that is remembered, |(q', omega q)| / sqrt(mass) [m/s].
  double difference() const;

 private:
  void load(const Equations& equations, double t, Eigen::VectorXd& held);
  void vibrate(double time);
  void turn_group(int first, int count, double time, const Vec3& spin);
  Vec3 inner_momentum(double spin) const;
  double pulled_on(const Body& body, const Eigen::VectorXd& amplitudes);
  /// How an obstacle stands to the body: the least gap [m], bounds of the speed and the acceleration at which it closes [m/s, m/s2].
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
  Count version_ = -1;  ///< of the body
  RigidBody body_;
  RigidState begin_, rigid_;
  double t0_ = 0, t_ = 0;                            ///< of `enter`, and of the rigid motion now [s]
  double deformation_ = 0;                           ///< the body's energy of vibration and deformation [J]
  Eigen::Matrix3d attitude_;                         ///< Q at `enter`
  Vec3 spin_;                                        ///< mean of the rigid motion's, in the body's axes [rad/s]
  Eigen::VectorXd q_, q_rate_, held_;                ///< (modes); held: s
  Eigen::VectorXd old_, old_rate_;                   ///< what is remembered
  Eigen::VectorXd displacement_, rate_, amplitude_;  ///< workspace
  Scalars way_;                                      ///< (points) largest excursion of each point [m]
  Scalars heights_;                                  ///< (points) workspace
  Points x_, v_, outside_;
};

}  // namespace softffd
