/// Free bodies: rigid bodies with a mass of their own, as obstacles or as frames of pins. The object and the outside move them.
///
/// Between contacts a free body flies: its centre of mass follows a parabola, its angular momentum L about the centre keeps every bit if
/// there is no torque, and it turns with the spin w = R I^-1 R' L. A body on a guide moves only along the guide.
#pragma once
#include <array>
#include <vector>

#include "model/rotation.hpp"
#include "model/visit.hpp"

namespace softffd {

/// Properties of a free body that a scene defines once.
struct FreeBody {
  int plane = -1, pin = -1;     ///< index of the obstacle that the body is, or of the pin whose frame it is; the other is -1
  double mass = 1;              ///< [kg]
  Vec3 inertia = Vec3::Ones();  ///< about the centre of mass, in the body's own axes, which are principal [kg m2]
  Vec3 guide = Vec3::Zero();    ///< unit vector of the only direction of motion; zero: no guide
  bool guided() const { return !guide.isZero(0); }
};

/// Loads that a host sets between steps.
struct FreeLoad {
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();            ///< on the body, torque about its centre [N], [N m]
  Vec3 force_rate = Vec3::Zero(), torque_rate = Vec3::Zero();  ///< their time derivatives [N/s], [N m/s]
  double mass = 1;                                             ///< [kg]; the inertia scales with it
};

/// Position and motion of a free body at one time.
struct FreeState {
  double time = 0;                                ///< time of the state [s]
  Vec3 position = Vec3::Zero();                   ///< centre of mass [m]
  std::array<double, 4> orientation{1, 0, 0, 0};  ///< unit quaternion w x y z of the turn from the world's axes to the body's
  Vec3 velocity = Vec3::Zero();                   ///< [m/s]
  Vec3 momentum = Vec3::Zero();                   ///< angular momentum about the centre [kg m2/s]

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.time, s.position, s.orientation, s.velocity, s.momentum);
  }
};
static_assert(visits_every_field<FreeState>);

/// Small motion of a rigid body: displacement of the centre and rotation vector, or the changes of velocity and spin.
struct Twist {
  Vec3 move = Vec3::Zero(), turn = Vec3::Zero();
  /// Returns the motion of the material at the end of an arm from the centre.
  Vec3 at(const Vec3& arm) const { return move + turn.cross(arm); }
};

/// A force on a body and its torque about a point, which is the body's centre unless said otherwise [N], [N m].
struct Wrench {
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.force, s.torque);
  }
};
static_assert(visits_every_field<Wrench>);

/// A free body under its loads, in flight from the state of the run. A free part is the frame of a pin and moves with the points of the
/// pin: its state is that of the common centre of mass, its orientation that of the frame. Loads change its motion only by kicks, like
/// forces on points.
class FreeMotion {
 public:
  /// states: free bodies of the run; `index` is the number of this body among them.
  FreeMotion(const FreeBody& body, const std::vector<FreeState>& states, int index);

  const FreeBody& body() const { return body_; }
  bool part() const { return body_.pin >= 0; }
  double mass() const { return mass_; }  ///< mass of the body and the points that it carries [kg]
  /// Reads the state from these states from now on.
  void follow(const std::vector<FreeState>& states) { states_ = &states; }
  /// load: at the body's own centre, gravity included, at the time `since`. arms, masses: positions in the frame [m] and masses [kg] of
  /// the points that the body carries.
  void load(const FreeLoad& load, double since, const std::vector<Vec3>& arms = {}, const std::vector<double>& masses = {});

  const FreeState& state() const { return (*states_)[index_]; }
  int index() const { return index_; }
  /// Returns the state after free flight from the run's state, or from another state.
  FreeState at(double time) const { return flown(state(), time); }
  FreeState flown(const FreeState& from, double time) const;
  /// Returns the state of the body's own centre for a state of the common centre.
  FreeState own(const FreeState& s) const;
  /// Returns the state of the common centre for a state of the body's own centre.
  FreeState whole(const FreeState& own, const Vec3& spin) const;

  Wrench loads(const FreeState& s) const;  ///< at the time of the state
  Wrench mean_loads(const FreeState& from, double h) const;
  bool loads_grow() const { return !load_.force_rate.isZero(0) || !load_.torque_rate.isZero(0); }
  Vec3 acceleration(const FreeState& s) const { return inverse_mass() * loads(s).force; }  ///< in flight, at the time of the state [m/s2]
  Vec3 spin(const FreeState& s) const;                                                     ///< [rad/s]
  Vec3 momentum(const FreeState& s, const Vec3& spin) const;                               ///< angular [kg m2/s]
  double kinetic_energy(const FreeState& s) const;                                         ///< of the body alone [J]
  double own_mass() const { return own_mass_; }                                            ///< mass of the body alone [kg]
  Eigen::Matrix3d inverse_mass() const;                                                    ///< only along the guide, if there is one [1/kg]
  Eigen::Matrix3d inverse_inertia(const FreeState& s) const;                               ///< in world axes; zero on a guide [1/(kg m2)]
  Eigen::Matrix3d inertia(const FreeState& s) const;                                       ///< in world axes [kg m2]
  /// Returns the end of a backward Euler step that gives the body this impulse in addition to its loads.
  FreeState stepped(const FreeState& from, double h, const Vec3& impulse, const Vec3& torque) const;
  /// Returns `from` after a motion for h [s] with the velocities of the state `by`; velocity and momentum stay those of `from`.
  FreeState moved(const FreeState& from, const FreeState& by, double h) const;
  /// Adds an impulse and its torque impulse about the centre to the state.
  void push(FreeState& s, const Vec3& impulse, const Vec3& torque) const;

 private:
  FreeBody body_;
  const std::vector<FreeState>* states_;
  int index_;
  double mass_, own_mass_;
  Eigen::Matrix3d inertia_, inverse_inertia_;  ///< of body and carried points, in the frame
  Vec3 own_inertia_;
  Vec3 centre_ = Vec3::Zero();  ///< common centre of mass, in the frame from the body's own centre [m]
  FreeLoad load_;
  double since_ = 0;
};

/// Returns the orientation turned by a rotation vector [rad] in world axes, or by a unit quaternion.
std::array<double, 4> turned(const std::array<double, 4>& orientation, const Vec3& by);
std::array<double, 4> turned(const std::array<double, 4>& orientation, const std::array<double, 4>& by);
/// Returns what takes one state to another: the change of each vector, and the turn of the axes.
FreeState difference(const FreeState& from, const FreeState& to);
/// Returns the state that differs by `difference` from a state.
FreeState beside(const FreeState& from, const FreeState& difference);
/// Returns the axes of a body of this orientation, in columns.
Eigen::Matrix3d axes_of(const std::array<double, 4>& orientation);

}  // namespace softffd
