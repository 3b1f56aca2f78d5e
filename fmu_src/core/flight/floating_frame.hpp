/// Free flight of a stiff body in long steps: its rigid motion on its own, and its deformation in a frame that takes part in it (floating
/// frame of reference; Shabana 2013, Dynamics of Multibody Systems, chapter 5).
///
///      x = c(t) + R(t) Q y,      Q: the attitude at the start, c(t), R(t): the motion of the body if it kept its shape.
///
/// Implicit methods take points along straight lines; what that stretches stiff springs by, they throw back, and the rotation gains or
/// loses energy. In the frame hardly anything moves. There the points feel the outside forces less the inertia of the frame's motion,
///
///      M y'' = spring forces(y) + g(t) - D y',      g = (R Q)^T (f - D x'_frame - M x''_frame),
///
/// which ROS34PW2 follows with one factor of one matrix, however the body turns: modes that are fast against the step go to their
/// equilibrium, slow ones are resolved. g is taken at both ends of the step for the shape of its beginning, and linear in between. What a
/// change of shape within the step would add to it, Coriolis' force above all, is part of the error estimate: a soft part that vibrates
/// slowly is left to other methods.
///
/// At the end the centre is the rigid body's, the spin follows from the angular momentum, and the attitude gets half a step of what the
/// rigid body's spin lacked. The angular momentum is the rigid body's with the moments of the outside forces on the changed shape: in
/// torque-free flight it stays as it is, to rounding. What the deformation loses counts as dissipated. There are no pins.
#pragma once
#include "flight/rigid_body.hpp"
#include "methods/ros34pw2.hpp"

namespace softffd {

class FloatingFrame final : public OneStep {
 public:
  /// The deformation is `deformation`'s to integrate; its `factored` is that of this method too, in the frame.
  FloatingFrame(const Lattice& lattice, Ros34pw2& deformation);
  double attempt(const Equations& equations, double t, double h, const State& state) override;

 private:
  Outcome attempt_in(const Equations& equations, double t, double h, Run& run) override;
  void take_material(const Model& model) override;
  void enter_frame(const Body& body, const State& state, const RigidState& rigid);
  void load_frame(const Equations& equations, double t, const RigidState& rigid, Points& load);
  double leave_frame(const Equations& equations, double t, double h, const RigidState& rigid);
  void lose(const Equations& equations, double t, double h, const State& state);

  Ros34pw2& deformation_;
  RigidBody body_;
  Drive around_;                 ///< in the frame
  State shape_;                  ///< in the frame, at the start
  Points rest_, arm_, outside_;  ///< rest positions; arms at the start, world axes [m]
  Eigen::Matrix3d attitude_;     ///< Q
};

}  // namespace softffd
