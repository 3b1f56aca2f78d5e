/// ROS34PW2 (Rang and Angermann 2005), order 3(2), four stages, as a W-method: its order holds for any matrix in place of the Jacobian, so
/// that one factor of an old stiffness matrix K serves many steps. For y = (x, v) the stages, in Hairer's transformed form with g = gamma
/// h,
///
///      (1/g - J) U_i = f(t + c_i h, y + sum a_ij U_j) + sum c_ij U_j / h + h gamma_i df/dt,        y+ = y + sum m_i U_i,
///
/// become one system each once the velocity part is eliminated, X and V being the two parts of U, p and q those of sum c_ij U_j / h:
///
///      (M/g^2 + D/g + K) X = F(t_i, x_i) + D p + M (q + (v_i + p)/g) + h gamma_i (dF/dt - K_pinned v_pinned),     V = X/g - v_i - p.
///
/// Dashpots add C/g to the matrix, the C of its own state, and C (v_i + p) - C(x_i) v_i to the right, theirs at the stage's.
///
/// Pinned points move as given: they are at their place at every stage, and their velocity is part of df/dt. A step costs four solutions
/// and three new evaluations of the spring forces.
///
/// What turns makes steps with strong dashpots lose angular momentum by the square of the angle in every step, whatever the error estimate
/// says: they hold springs to the lengths that tangents give. A body without pins therefore has its angular momentum as one more unknown,
/// with no row in the matrix; its slopes are the outside torques at the stages, of the same order, and none without outside forces. Its
/// spin at the end of a step is what that says.
///
/// With h omega >> 1 an old factor serves only while springs keep their directions and their tension: a body that has been loaded or has
/// turned since then may blow up. The error estimate shows it; where nobody looks at the estimate, `refresh` before every step. Impulses
/// on pins balance the body's momentum to rounding. Their torque and work are of third order, but where a frame turns by an angle a per
/// step, the error grows as k a^3; the work of a frame that accelerates by A errs by 0.0025 h^2 A times the change of the force on it.
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
  /// Steps tried with one factor before it is made anew.
  static constexpr Count most_uses = 20;

  Ros34pw2(const Lattice& lattice, int pins);
  double attempt(const Equations& equations, double t, double h, const State& state) override;

  /// Share of an undamped vibration's amplitude that a step leaves, by omega h.
  static double kept(double y);

  /// An attempt with the factor that the run carries on, in the body's frame or out of it.
  template <class Attempt>
  Outcome with_factor_of(Run& run, bool in_frame, Attempt&& attempt) {
    Factored& carried = run.control.factored;
    if (carried.in_frame != in_frame) carried.in_frame = in_frame, carried.h = 0;
    std::swap(factored, carried);
    const double error = attempt();
    std::swap(factored, carried);
    const bool made = carried.uses == 1;  // not whether it was made now: after a restore it is made again
    run.control.factors += made;
    const double longer = (solutions_ - stages) * implicit_.solution;  // than solutions usually take
    return {.error = error, .work = implicit_.step + (made ? implicit_.factor : 0) + (in_frame ? implicit_.frame : 0) + longer};
  }
  /// The next attempt takes the stiffness at its own state.
  void refresh() { factored.h = 0; }
  Count factorizations() const override { return factorizations_; }

  /// What the next step's factor is made from, if the step is `h` long and it has not served its time; attempts keep it up to date. Part of
  /// every snapshot: the factor follows from it and from the body.
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
  Factored held_;       ///< what matrix_ is the factor of
  Count version_ = -1;  ///< of the body that it was made with
  ImplicitWork implicit_;
  Count factorizations_ = 0;
  bool torques_ = false;          ///< the outside torques are wanted
  Vec3 given_ = Vec3::Zero();     ///< by them to the angular momentum about the centre, in the last attempt [kg m2/s]
  double solutions_ = 0;          ///< of the last attempt, as LatticeMatrix counts them
  Points mass_, damping_, free_;  ///< per coordinate [kg], [N s/m], 1; 0 where pinned
  Scalars diagonal_;
  std::array<Points, stages> x_, v_;  ///< U, pinned points 0
  Points stage_x_, stage_v_, spring_, outside_, p_, q_, zero_;
  Points pin_velocity_, pin_acceleration_;  ///< 0 where free [m/s], and without dashpots [m/s2]
  Points pin_rate_;                         ///< at which the inner forces change by them [N/s]
  Points correction_;                       ///< J U on the pinned points [N]
};

}  // namespace softffd
