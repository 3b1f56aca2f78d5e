/// Free flight of a stiff body in long steps. The rigid motion is integrated on its own, and the deformation in a frame that moves with it
/// (floating frame of reference; Shabana 2013, Dynamics of Multibody Systems, chapter 5).
///
///      x = c(t) + R(t) Q y,      Q: the attitude at the start, c(t), R(t): the motion of the body if it kept its shape.
///
/// Implicit methods move points along straight lines. This stretches stiff springs, which throw the points back, and the rotation gains or
/// loses energy. In the frame hardly anything moves. There the outside forces act on the points, less the inertia of the frame's motion,
///
///      M y'' = spring forces(y) + g(t) - D y',      g = (R Q)^T (f - D x'_frame - M x''_frame),
///
/// which ROS34PW2 integrates with one factor of one matrix, however the body turns: modes that are fast compared with the step go to their
/// equilibrium, slow modes are resolved. g is evaluated at both ends of the step, for the shape at its beginning, and is linear in
/// between. What a change of shape within the step would add to g, Coriolis' force above all, is part of the error estimate: a soft part
/// that vibrates slowly is left to other methods.
///
/// At the end of the step the centre is that of the rigid body, the spin follows from the angular momentum, and the attitude is corrected
/// by half a step of what the rigid body's spin lacked. That is second order in the step. The next order, the lag times a sixth of the
/// turn within the step, is part of the error estimate, together with its growth while the body tumbles (kit/tumbling.hpp). The angular
/// momentum is that of the rigid body plus the moments of the outside forces on the change of shape: torque-free flight conserves it to
/// rounding. What the deformation loses counts as dissipated. There are no pins.
#pragma once
#include "flight/rigid_body.hpp"
#include "methods/ros34pw2.hpp"

namespace softffd {

class FloatingFrame final : public OneStep {
 public:
  /// `deformation` integrates the deformation; its `factored` is also the factor of this method, in the frame.
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
  Drive around_;                 ///< forces in the frame
  State shape_;                  ///< state in the frame, at the start of the step
  Points rest_, arm_, outside_;  ///< rest positions [m]; arms at the start, in world axes [m]; workspace
  Eigen::Matrix3d attitude_;     ///< Q
  double growth_ = 1;            ///< of errors of the attitude until the end of the run (kit/tumbling.hpp)
};

}  // namespace softffd
