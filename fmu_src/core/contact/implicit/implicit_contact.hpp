/// Contact of stiff bodies in implicit steps that are long compared with the body's oscillations: backward Euler, and the method of second
/// order whose two stages are such steps (implicit_stage.hpp).
///
/// Backward Euler damps motions that its step is too long for, and preserves equilibrium, sliding and rigid motion. The outside forces are
/// those of mid-step, so that ramps give their whole impulse. The first-order error takes energy from rotations too, the fraction
/// |omega| h / 2 per radian, and a bounce is over after two steps. If Newton's method does not converge, or its solution has gained
/// energy, then the solution is on another branch or there is none: the step is done in two halves.
///
/// SDIRK2 (Alexander 1977) with g = 1 - 1 / sqrt(2): L-stable, stiffly accurate, second order,
///
///      stage 1   (x1, v1) from (x0, v0) over g h
///      stage 2   (x, v) from (x0 + (1 - g) h v1, v0 + (1 - g) / g (v1 - v0)) over g h: the end of the step
///
/// with loads, obstacles and pins as they are at t + g h and t + h, and relative to the motion that pins or an obstacle carry the body with
/// (carried.hpp). Both stages obey the law of contact, hence the end of the step does. Impulses, work and losses of the step are
/// (1 - g) / g times those of stage 1 plus those of stage 2. A step in which a place strikes is one of backward Euler: stage 2 would throw
/// back what stage 1 stops.
#pragma once
#include "contact/free/isolated.hpp"
#include "contact/implicit/implicit_stage.hpp"

namespace softffd {

class ImplicitContact {
 public:
  /// samples: points of the surface that planes meet; null: planes meet the control points.
  ImplicitContact(const Lattice& lattice, int planes, int pins, const Samples* samples = nullptr);

  /// Call when masses, stiffness or damping change.
  void body_changed() { stage_.body_changed(); }
  /// Sets the kept matrix, a part of the state: from now on a step begins with it where it serves, and stores its own matrix there.
  void keep(Factored& kept) { kept_ = &kept; }
  /// Takes one step of length h [s] from (t, state) by backward Euler; state.spring are the internal forces at state.x. No point may be
  /// behind a plane at t. The caller advances state.time. On failure state and exchange are spoilt. not_finite: there was no solution down
  /// to h / 2^20, or none within the allowed numbers of factorizations and of solutions with them.
  StepStatus advance(const Equations& equations, double t, double h, bool watch, State& state, Exchange& exchange);
  /// Takes the step by SDIRK2. With span.way > 0, a step without a solution to that distance [m] fails and is not done in parts, because
  /// the caller, which controls the error, does that. With span.way = 0 it is done by backward Euler. span.again: the last matrix may
  /// serve.
  StepStatus advance_sdirk2(const Equations& equations, double t, double h, const Span& span, bool watch, State& state, Exchange& exchange);
  Count most_factorizations = 100'000, most_solutions = Count{1} << 53;
  double most_operations = std::numeric_limits<double>::infinity();
  /// Energy that obstacles and pins gave the body in the last call, friction included [J]. Points that move along obstacles count with the
  /// mean of their velocities before and after.
  double given() const { return given_; }
  /// Slip of the contacts in the last call.
  const Slip& slip() const { return slip_; }
  /// Hash of the contacts at the end of the last step and of which of them slide: another set has another number.
  Count constraints() const { return stage_.constraints(); }
  /// Energy that the last step of SDIRK2 lost beyond what dampers and friction took [J].
  double lost() const { return lost_; }
  /// Largest difference of a point's displacement between an embedded formula of third order and the last step of SDIRK2 [m]; infinite for
  /// a step in which a place strikes an obstacle.
  double bend() const { return bend_; }

  /// Fraction of an undamped vibration's amplitude that a step of SDIRK2 of length `angle` [rad] keeps [1].
  static double kept(double angle);

  /// Counted since the start.
  Count steps() const { return steps_; }        ///< steps tried
  Count halvings() const { return halvings_; }  ///< steps that had to be done in two halves
  Count iterations() const { return stage_.iterations(); }
  Count factorizations() const { return stage_.factorizations(); }
  double solutions() const { return stage_.solutions(); }
  double operations() const { return stage_.operations(); }  ///< of the last call

 private:
  using Step = ImplicitStage::Step;
  void begin_call();
  StepStatus advance_in_parts(const Equations& equations, double t, double h, bool watch, State& state, Exchange& exchange, int depth);
  StepStatus take_euler(const Step& step, bool watch, State& state, Exchange& exchange, bool count);
  StepStatus take_sdirk2(const Equations& equations, double t, double h, const Span& span, bool watch, State& state, Exchange& exchange);
  StepStatus strike(const Equations& equations, double t, double h, bool watch, State& state, Exchange& exchange);
  bool close(const Step& step, double outside, double work, bool watch, double ramp_work, Exchange& exchange);
  void open(const Step& step);
  void add_torques(double weight);
  void turn_back(bool watch, Exchange& exchange);
  void take(State& state);

  ImplicitStage stage_;
  Factored* kept_ = nullptr;
  Exchange before_;
  State start_;           ///< at the start of the second stage
  Points first_v_;        ///< velocities at the end of the first stage [m/s]
  double given_ = 0;      ///< in the last call [J]
  Slip slip_;             ///< in the last call
  double free_work_ = 0;  ///< work of free bodies on the object in the step [J]
  std::vector<FreeState> first_free_;
  Isolated isolated_;
  bool alone_ = false;  ///< object and free bodies are isolated
  double bend_ = 0, lost_ = 0;
  Count steps_ = 0, halvings_ = 0;
};

}  // namespace softffd
