/// Free bodies: rigid ones with a mass of their own, obstacles or the frames of pins, that move by what the object and the outside do to
/// them.
///
/// Between contacts a free body flies: its centre of mass goes on a parabola, its angular momentum L about that keeps every bit without a
/// torque, and it turns by w = R I^-1 R' L. One on a guide moves along that alone.
#pragma once
#include <array>
#include <vector>

#include "model/rotation.hpp"
#include "model/visit.hpp"

namespace softffd {

/// What a scene defines of it for good.
struct FreeBody {
  int plane = -1, pin = -1;     ///< the obstacle that it is, or the pin whose frame it is; the other is -1
  double mass = 1;              ///< [kg]
  Vec3 inertia = Vec3::Ones();  ///< about the centre of mass, in its own axes, which are principal [kg m2]
  Vec3 guide = Vec3::Zero();    ///< unit vector along which alone it moves; zero: none
  bool guided() const { return !guide.isZero(0); }
};

/// What a host sets between steps.
struct FreeLoad {
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();            ///< on it, the torque about its centre [N], [N m]
  Vec3 force_rate = Vec3::Zero(), torque_rate = Vec3::Zero();  ///< their time derivatives [N/s], [N m/s]
  double mass = 1;                                             ///< [kg]; the inertia goes with it
};

/// Where it is and how it moves.
struct FreeState {
  double time = 0;                                ///< of all this [s]
  Vec3 position = Vec3::Zero();                   ///< of its centre of mass [m]
  std::array<double, 4> orientation{1, 0, 0, 0};  ///< unit quaternion w x y z that turns its own axes from the world's
  Vec3 velocity = Vec3::Zero();                   ///< [m/s]
  Vec3 momentum = Vec3::Zero();                   ///< angular, about its centre [kg m2/s]

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.time, s.position, s.orientation, s.velocity, s.momentum);
  }
};
static_assert(visits_every_field<FreeState>);

/// Motion of a rigid body by a small step: its centre's way and its rotation vector, or the changes of its velocities.
struct Twist {
  Vec3 move = Vec3::Zero(), turn = Vec3::Zero();
  /// Of its material at the end of an arm from its centre.
  Vec3 at(const Vec3& arm) const { return move + turn.cross(arm); }
};

/// A force on it and its torque about the centre [N], [N m].
struct Wrench {
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
};

/// A free body under its loads, in flight from the state of the run. A pin's part goes with the points that the pin holds: the state is of
/// the centre of both, the orientation that of the pin's frame, and loads change its motion by kicks alone, as the forces of the points do.
class FreeMotion {
 public:
  /// states: of the run, whose number `index` this body is.
  FreeMotion(const FreeBody& body, const std::vector<FreeState>& states, int index);

  const FreeBody& body() const { return body_; }
  bool part() const { return body_.pin >= 0; }
  double mass() const { return mass_; }  ///< of all that moves [kg]
  /// The states are these from now on.
  void follow(const std::vector<FreeState>& states) { states_ = &states; }
  /// load: at its own centre, gravity included, as it is at the time `since`. arms: in the frame, of the points that it takes along [m], of
  /// these masses [kg].
  void load(const FreeLoad& load, double since, const std::vector<Vec3>& arms = {}, const std::vector<double>& masses = {});

  const FreeState& state() const { return (*states_)[index_]; }
  int index() const { return index_; }
  /// In free flight from the run's state, or from another one.
  FreeState at(double time) const { return flown(state(), time); }
  FreeState flown(const FreeState& from, double time) const;
  /// Its own centre, in the place of that of all that moves.
  FreeState own(const FreeState& s) const;
  /// A state of its own centre, as a state of all that moves.
  FreeState whole(const FreeState& own, const Vec3& spin) const;

  Wrench loads(const FreeState& s) const;  ///< at the time of the state
  Wrench mean_loads(const FreeState& from, double h) const;
  bool loads_grow() const { return !load_.force_rate.isZero(0) || !load_.torque_rate.isZero(0); }
  Vec3 acceleration(const FreeState& s) const { return inverse_mass() * loads(s).force; }  ///< in flight, at the time of the state [m/s2]
  Vec3 spin(const FreeState& s) const;                                                     ///< [rad/s]
  Vec3 momentum(const FreeState& s, const Vec3& spin) const;                               ///< angular [kg m2/s]
  double kinetic_energy(const FreeState& s) const;                                         ///< of its own [J]
  double own_mass() const { return own_mass_; }                                            ///< [kg]
  Eigen::Matrix3d inverse_mass() const;                       ///< along the guide alone, where there is one [1/kg]
  Eigen::Matrix3d inverse_inertia(const FreeState& s) const;  ///< in the world; zero on a guide [1/(kg m2)]
  Eigen::Matrix3d inertia(const FreeState& s) const;          ///< in the world [kg m2]
  /// The end of a step of backward Euler that gives it such an impulse beside its loads.
  FreeState stepped(const FreeState& from, double h, const Vec3& impulse, const Vec3& torque) const;
  /// Gone on for h with the velocities of a state, from a place and momenta of another.
  FreeState moved(const FreeState& from, const FreeState& by, double h) const;
  /// Adds such an impulse to the state.
  void push(FreeState& s, const Vec3& impulse, const Vec3& torque) const;

 private:
  FreeBody body_;
  const std::vector<FreeState>* states_;
  int index_;
  double mass_, own_mass_;
  Eigen::Matrix3d inertia_, inverse_inertia_;  ///< of all that moves, in the frame
  Vec3 own_inertia_;
  Vec3 centre_ = Vec3::Zero();  ///< of all that moves, in the frame from its own [m]
  FreeLoad load_;
  double since_ = 0;
};

/// The orientation turned by a rotation vector [rad] of the world, or by a unit quaternion.
std::array<double, 4> turned(const std::array<double, 4>& orientation, const Vec3& by);
std::array<double, 4> turned(const std::array<double, 4>& orientation, const std::array<double, 4>& by);
/// What takes a state to another one: the change of each of its vectors, and the turn of its axes.
FreeState difference(const FreeState& from, const FreeState& to);
/// Where a state goes by that.
FreeState beside(const FreeState& from, const FreeState& difference);
/// Its axes in columns.
Eigen::Matrix3d axes_of(const std::array<double, 4>& orientation);

}  // namespace softffd
