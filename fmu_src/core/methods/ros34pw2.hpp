/// ROS34PW2 (Rang and Angermann 2005), order 3(2), four stages, as a W-method: its order holds for any matrix in place of the Jacobian, so
/// that one factor of an old stiffness matrix K serves many steps. For y = (x, v) the stages, in Hairer's transformed form with g = gamma
/// h,
///
///      (1/g - J) U_i = f(t + c_i h, y + sum a_ij U_j) + sum c_ij U_j / h + h gamma_i df/dt,        y+ = y + sum m_i U_i,
///
/// become one system each when the velocity part is eliminated; X and V are the two parts of U, p and q the two parts of sum c_ij U_j / h:
///
///      (M/g^2 + D/g + K) X = F(t_i, x_i) + D p + M (q + (v_i + p)/g) + h gamma_i (dF/dt - K_pinned v_pinned),     V = X/g - v_i - p.
///
/// Dashpots add C/g to the matrix, with C at the state of the matrix, and C (v_i + p) - C(x_i) v_i to the right-hand side, with C(x_i) at
/// the state of the stage.
///
/// Pinned points have a prescribed motion: they are at their place at every stage, and their velocity is part of df/dt. A step costs four
/// solutions and three new evaluations of the spring forces.
///
/// In a turning body strong dashpots hold springs to the lengths that motion along tangents gives. Each step then loses angular momentum
/// by the square of the angle, whatever the error estimate says. For a body without pins the angular momentum is therefore one more
/// unknown, without a row in the matrix. Its slopes are the outside torques at the stages: it has the same order, and is constant without
/// outside forces. The spin at the end of a step follows from it.
///
/// If h omega >> 1, an old factor serves only while springs keep their directions and their tension: a body that has been loaded or has
/// turned since then may blow up. The error estimate shows this; if the estimate is not checked, call `refresh` before every step.
/// Impulses on pins balance the momentum of the body to rounding. Their torque and work are of third order, but if a frame turns by an
/// angle a per step, the error grows as k a^3; the work of a frame with acceleration A errs by 0.0025 h^2 A times the change of the force
/// on the frame.
#pragma once
#include <array>
#include <utility>

#include "matrix/stiffness_matrix.hpp"
#include "methods/one_step.hpp"
#include "methods/traits.hpp"
#include "model/state.hpp"

namespace softffd {

class Ros34pw2 final : public OneStep {
 public:
  static constexpr int stages = 4;
  /// Largest number of steps tried with one factor.
  static constexpr Count most_uses = 20;

  Ros34pw2(const Lattice& lattice, int pins);
  double attempt(const Equations& equations, double t, double h, const State& state) override;

  /// Returns the fraction of the amplitude of an undamped vibration that a step leaves [1]. y: omega h.
  static double kept(double y);

  /// Makes an attempt with the factor that the run carries on, in the body's frame or outside it.
  template <class Attempt>
  Outcome with_factor_of(Run& run, bool in_frame, Attempt&& attempt) {
    Factored& carried = run.control.factored;
    if (carried.in_frame != in_frame) carried.in_frame = in_frame, carried.h = 0;
    std::swap(factored, carried);
    const double error = attempt();
    std::swap(factored, carried);
    const bool made = carried.uses == 1;  // not whether this call made it: after a restore the factor is made again
    run.control.factors += made;
    const double longer = (solutions_ - stages) * implicit_.solution;  // work beyond that of usual solutions
    return {.error = error, .work = implicit_.step + (made ? implicit_.factor : 0) + (in_frame ? implicit_.frame : 0) + longer};
  }
  /// Makes the next attempt take the stiffness at its own state.
  void refresh() { factored.h = 0; }
  Count factorizations() const override { return factorizations_; }

  /// What the factor of the next step is made from, unless the step is not `h` long or the factor has served `most_uses` steps; attempts
  /// keep it up to date. Part of every snapshot: the factor follows from this and from the body.
  Factored factored;

 protected:
  Outcome attempt_in(const Equations& equations, double t, double h, Run& run) override;

 private:
  void factorize(const Body& body);
  void use_factor(const Body& body, double h, const Points& x);
  void record_stage(const Equations& equations, double weight, double at, double ahead, int i);
  void record_ends(const Equations& equations, double t, double h, const State& state);
  void add_dashpots(const Body& body, Points& right);
  void add_torque(const Body& body, double weight, const Points& outside);
  void turn_by_torques(const Body& body, const State& state);
  bool pins_move(const Equations& equations, double t, double h);

  LatticeMatrix matrix_;
  Factored held_;       ///< what matrix_ was factored from
  Count version_ = -1;  ///< version of the body that it was made with
  ImplicitWork implicit_;
  Count factorizations_ = 0;
  bool torques_ = false;          ///< the outside torques are to be summed
  Vec3 given_ = Vec3::Zero();     ///< angular momentum about the centre from outside torques in the last attempt [kg m2/s]
  double solutions_ = 0;          ///< of the last attempt, as LatticeMatrix counts them
  Points mass_, damping_, free_;  ///< per coordinate [kg], [N s/m], 1; 0 where pinned
  Scalars diagonal_;
  std::array<Points, stages> x_, v_;  ///< the two parts of U at the stages; 0 at pinned points
  Points stage_x_, stage_v_, spring_, outside_, p_, q_, zero_;
  Points pin_velocity_, pin_acceleration_;  ///< [m/s], [m/s2]; 0 at free points; accelerations are 0 without dashpots
  Points pin_rate_;                         ///< rate of change of the inner forces by the motion of the pins [N/s]
  Points correction_;                       ///< J U on the pinned points [N]
};

}  // namespace softffd
