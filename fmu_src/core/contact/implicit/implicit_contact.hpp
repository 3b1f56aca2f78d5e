/// Contact of stiff bodies in implicit steps, for steps that are long compared with the body's oscillations: backward Euler, and the method
/// of second order whose stages are two such steps (implicit_stage.hpp).
///
/// Backward Euler damps what it cannot follow and keeps equilibrium, sliding and rigid motion. Its outside forces are those of mid-step, so
/// that ramps give their whole impulse. Its first-order error takes energy from rotations too, the share |omega| h / 2 a radian, and a
/// bounce is over after two steps. A Newton's method that does not converge, or a solution that has gained energy, is another branch or
/// none: the step is done in two halves.
///
/// SDIRK2 (Alexander 1977) with g = 1 - 1 / sqrt(2): L-stable, stiffly accurate, second order,
///
///      stage 1   (x1, v1) from (x0, v0) over g h
///      stage 2   (x, v) from (x0 + (1 - g) h v1, v0 + (1 - g) / g (v1 - v0)) over g h: the end of the step
///
/// with loads, obstacles and pins as they are at t + g h and t + h. Both stages obey the contact's law, so the step's end does; impulses,
/// work and losses of the step are (1 - g) / g times those of stage 1 and those of stage 2. A step in which a place strikes an obstacle is
/// one of backward Euler: the second stage would throw back what the first one stops.
#pragma once
#include "contact/free/isolated.hpp"
#include "contact/implicit/implicit_stage.hpp"

namespace softffd {

class ImplicitContact {
 public:
  /// samples: of the surface, which planes meet; null: they meet the control points.
  ImplicitContact(const Lattice& lattice, int planes, int pins, const Samples* samples = nullptr);

  /// Call when masses, stiffness or damping change.
  void body_changed() { stage_.body_changed(); }
  /// From now on steps begin with this matrix, where it serves, and leave theirs there. It belongs to the state.
  void keep(Factored& kept) { kept_ = &kept; }
  /// One step from (t, state) of length h [s]; state.spring being the internal forces at state.x. Planes have no point behind them at t.
  /// state.time is the caller's. On failure state and exchange are spoilt; not_finite: there was no solution down to h / 2^20, or not
  /// with so many factorizations and solutions with them.
  StepStatus advance(const Equations& equations, double t, double h, bool watch, State& state, Exchange& exchange);
  /// The same by SDIRK2. A step that finds no solution to span.way is not done in parts, because who controls its error does that; if there
  /// is no such way, it is done by backward Euler. span.again: the matrix of the step before may serve.
  StepStatus advance_sdirk2(const Equations& equations, double t, double h, const Span& span, bool watch, State& state, Exchange& exchange);
  Count most_factorizations = 100'000, most_solutions = Count{1} << 53;
  double most_operations = std::numeric_limits<double>::infinity();
  /// Energy that obstacles and pins gave the body in the last call, friction included, points moving along obstacles with the mean of their
  /// velocities before and after [J].
  double given() const { return given_; }
  /// How contacts slipped in the last call.
  const Slip& slip() const { return slip_; }
  /// What touches at the end of the last step, and what of it slides: another number where it is another set.
  Count constraints() const { return stage_.constraints(); }
  /// Energy that the last step of SDIRK2 took beyond dampers and friction [J].
  double lost() const { return lost_; }
  /// What an embedded formula of third order would move points by more in the last step of SDIRK2, at most [m]; infinite of a step that
  /// strikes.
  double bend() const { return bend_; }

  /// Of an undamped vibration's amplitude, what a step of SDIRK2 keeps that is so many radians long [1].
  static double kept(double angle);

  /// Counted since the start.
  Count steps() const { return steps_; }        ///< tried; of which
  Count halvings() const { return halvings_; }  ///< had to be done in two halves
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
  State start_;           ///< of the second stage
  Points first_v_;        ///< velocities at the end of the first stage [m/s]
  double given_ = 0;      ///< of the call [J]
  Slip slip_;             ///< of the call
  double free_work_ = 0;  ///< of free bodies on the object in the step [J]
  std::vector<FreeState> first_free_;
  Isolated isolated_;
  bool alone_ = false;  ///< object and free bodies are isolated
  double bend_ = 0, lost_ = 0;
  Count steps_ = 0, halvings_ = 0;
};

}  // namespace softffd
