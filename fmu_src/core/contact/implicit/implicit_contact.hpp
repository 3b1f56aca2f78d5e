/// Contact of stiff bodies: backward Euler with exact contact, for steps that are long compared with the body's oscillations.
///
///      M (v1 - v0) / h = internal forces(x1) + outside forces - D v1 - C(x1) v1 + contact(x1),      v1 = (x1 - x0) / h,
///
/// no control point, or no sample of the surface, being behind a plane at x1, loads pushing only, friction by Coulomb's law. The outside
/// forces are those of mid-step, so that ramps give their whole impulse. A stiff body oscillates faster than a step can follow: backward
/// Euler damps what it cannot follow and keeps equilibrium, sliding and rigid motion. Its first-order error takes energy from rotations
/// too, the share |omega| h / 2 a radian, and a bounce is over after two steps.
///
/// Newton's method, from the rigid motion that the body would have without forces. Three things make it converge in two or three
/// iterations where the springs are stiff:
///   - the rotation in each Newton step is carried out as a rotation (rigid_motion.hpp): straight, it would stretch the springs;
///   - touches and loads are exact for the linearised equations (linear_contact.hpp; of samples of the surface surface_touches.hpp),
///     friction and loads together;
///   - the first guess of the loads takes the points on planes to be in equilibrium: at rest and in steady sliding it is the solution.
/// The factor is kept while changes fall by ten from one iteration to the next. A Newton's method that does not converge, or a solution
/// that has gained energy, is another branch or none: the step is done in two halves.
///
/// What the planes are reported to receive is the momentum that the body lost, to rounding.
#pragma once
#include <memory>

#include "contact/implicit/convergence.hpp"
#include "contact/implicit/implicit_touches.hpp"
#include "contact/slip.hpp"

namespace softffd {

class ImplicitContact {
 public:
  /// samples: of the surface, which planes meet; null: they meet the control points.
  ImplicitContact(const Lattice& lattice, int planes, const Samples* samples = nullptr);

  /// Call when masses, stiffness or damping change.
  void body_changed() { largest_stiffness_ = -1; }
  /// One step from (t, state) of length h [s]; state.spring being the internal forces at state.x. Planes have no point behind them at t.
  /// state.time is the caller's. On failure state and exchange are spoilt; not_finite: there was no solution down to h / 2^20, or not
  /// with so many factorizations and solutions with them.
  StepStatus advance(const Equations& equations, double t, double h, bool watch, State& state, Exchange& exchange);
  Count most_factorizations = 100'000, most_solutions = Count{1} << 53;
  /// Energy that obstacles and pins gave the body in the last call, friction included, points moving along obstacles with the mean of their
  /// velocities before and after [J].
  double given() const { return given_; }
  /// How contacts slipped in the last call.
  const Slip& slip() const { return slip_; }

  /// Counted since the start.
  Count steps() const { return steps_; }        ///< tried; of which
  Count halvings() const { return halvings_; }  ///< had to be done in two halves
  Count iterations() const { return iterations_; }
  Count factorizations() const { return touches_->matrix().factorizations(); }
  double solutions() const { return touches_->matrix().solutions(); }  ///< as LatticeMatrix counts them

 private:
  using Step = ImplicitTouches::Step;
  using Reaction = ImplicitTouches::Reaction;
  StepStatus advance_in_parts(const Equations& equations, double t, double h, bool watch, State& state, Exchange& exchange, int depth);
  bool spent() const { return factorizations() >= last_factorization_ || solutions() >= last_solution_; }
  StepStatus open(const Step& step);
  void predict(const Step& step);
  StepStatus solve(const Step& step);
  void find_residual(const Step& step, bool first);
  bool in_balance(const Step& step);
  void move(const Step& step);
  void keep_converging();
  bool close(const Step& step);
  void spread_rounding(const Step& step);
  double contact_work(const Step& step) const;
  double given_by_contacts(const Step& step) const;
  Slip slip_of_contacts(const Step& step) const;
  Vec3 material_velocity(const Step& step, const Reaction& at) const;
  Vec3 impulse(const Step& step, const Reaction& reaction) const;
  Vec3 pin_impulse(const Step& step, int p) const;
  void book(const Step& step, bool watch, Exchange& exchange) const;

  std::unique_ptr<ImplicitTouches> touches_;
  std::vector<Reaction> reactions_;  ///< of the step that was solved
  Scalars diagonal_;                 ///< of the inertia and the damping (points) [N/m]
  Points x_, v_, u_;                 ///< at the end of the step; u: displacement in the step
  Points force_, spring_, residual_, last_change_, scratch_;
  double largest_stiffness_ = -1, force_scale_ = 0, noise_ = 0, extent_ = 0, slight_ = 0;
  Convergence convergence_;
  bool straight_ = false;  ///< the last Newton step was taken as the linear equations have it
  Vec3 rounding_ = Vec3::Zero();
  double loss_ = 0, work_ = 0;  ///< of the step [J]
  double given_ = 0;            ///< of the call [J]
  Slip slip_;                   ///< of the call
  Count steps_ = 0, halvings_ = 0, iterations_ = 0, last_factorization_ = 0;
  double last_solution_ = 0;
};

}  // namespace softffd
