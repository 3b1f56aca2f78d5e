/// Takes a soft body through one communication step: the method asked for, or the one that costs least; steps that are stable and keep
/// the tolerance; contact wherever an obstacle is within reach.
///
/// A fixed-step method follows the tolerance by calibration: every now and then a short stretch is run twice, with h and h / 2. What they
/// differ by, D, grows with the length of the run, so that the step that ends within the tolerance is
///
///      h (share tolerance / (c D T / stretch))^(1/p),      c = 2^p / (2^p - 1),
///
/// where T is the length of the run or the time in which damping forgets, whichever is shorter. Methods with error control adapt at every
/// step. The automatic choice is a race: each candidate is tried on a short stretch and the least work for the communication step wins.
/// In contact leapfrog runs every stretch twice (propagator_contact.cpp), and stiff bodies take implicit steps (implicit_contact.hpp).
/// Where the lattice is too wide for matrices (layer_matrix.hpp) there are no implicit steps.
#pragma once
#include <cmath>
#include <optional>

#include "contact/implicit_contact.hpp"
#include "contact/reach.hpp"
#include "flight/floating_frame.hpp"
#include "forces/stability.hpp"
#include "methods/bm4.hpp"
#include "methods/central_difference.hpp"
#include "methods/dop853.hpp"
#include "methods/leapfrog.hpp"
#include "methods/rkn12.hpp"
#include "methods/ros34pw2.hpp"
#include "methods/traits.hpp"
#include "stepping/course.hpp"

namespace softffd {

class Propagator {
 public:
  /// Internal steps that one call may take; a longer communication step is refused.
  static constexpr Count most_steps = 20'000'000;

  Propagator(const Lattice& lattice, int planes, int pins);
  /// Call when masses, stiffness or damping change.
  void body_changed(const Body& body, Course& course);
  /// From state.time to state.time + H. On failure state, course and exchange are spoilt and the caller restores them.
  StepStatus advance(const Equations& equations, const Request& request, double H, State& state, Course& course, Exchange& exchange);
  /// Number of matrices factored since the start: none unless implicit steps are tried.
  Count factorizations() const { return ros34pw2_ ? ros34pw2_->factorizations() + implicit_contact_->factorizations() : 0; }
  /// Largest stable leapfrog step at x, by bound [s]; the largest finite number if nothing resists.
  double stable_step(const Body& body, const Points& x);
  /// Size of vibrations of this energy [J], of a time scale up to `slowest` [s], spread over the body [m].
  double amplitude(const Body& body, double energy, double slowest) const;

 private:
  /// The communication step at hand.
  struct Job {
    const Equations& equations;
    const Request& request;
    State& state;
    Course& course;
    Exchange& exchange;
  };
  /// Of a number of internal steps that cannot be: not a number where the state has gone astray.
  static StepStatus refusal(double steps) { return std::isnan(steps) ? StepStatus::not_finite : StepStatus::too_many_steps; }
  static Count counted_units(const Request& request, double H);
  StepStatus advance_near(const Job& job, Method method, double H);
  StepStatus advance_in_contact(const Job& job, Method asked, double H);
  bool fly_on(const Job& job, double H);
  StepStatus advance_with(const Job& job, Method asked, double H);
  bool passes(const Equations& equations, Method method, double t, double h, const Points& x0, const Points& v0, const Points& x,
              const Points& v);
  StepStatus run_counted(const Job& job, Method method, Count units);
  StepStatus run_fitted(const Job& job, Method method, double end, double pause_at);
  StepStatus run_controlled(const Job& job, Method method, double end, double pause_at);
  StepStatus run_stretch(const Job& job, Method method, double h, Count steps);
  StepStatus take_steps(const Job& job, Method method, const Span& span, State& state, Exchange& exchange);
  double step_limit(const Job& job, Method method, bool given);
  double bound(const Job& job);
  double turning_limit(const Job& job, const Points& x, const Points& v);
  bool deformed_since_bound(const Job& job) const;

  bool calibration_due(const Job& job, const Calibration& calibration, double H, bool jolt);
  double calibrate(const Job& job, Method method, double H, int rounds);
  StepStatus run_implicit(const Job& job, double end);
  StepStatus run_doubled(const Job& job, double end);
  /// What states a and b, after the same stretch of time [s] from one state, will differ by at the end of the run, if the difference keeps
  /// growing until damping forgets it [m].
  double growing(const Job& job, const State& a, const State& b, double stretch) const;
  double trial_error(const Job& job, Method method, double h, Count steps);
  void choose(const Job& job, double H);
  void race(const Job& job, double H);
  bool worth_a_matrix(const Job& job, Method method, double H, double least);
  double controlled_work(const Job& job, Method method, double H, double& spent);
  double implicit_work(const Job& job, Method method, double H, double budget, double& spent);
  Method implicit_method(const Job& job, double H);
  bool fast_modes_are_quiet(const Job& job, Method method, double H, double& spent);
  void take_trial(const Job& job);
  double attempt(const Job& job, Method method, double t, double h);

  OneStep& controlled(Method method);
  double& controlled_step(Course& course, Method method);
  static void accept(OneStep& trial, const Equations& equations, State& state, Exchange& exchange);

  Stability stability_;
  Leapfrog leapfrog_;
  CentralDifference central_difference_;
  Bm4 bm4_;
  Rkn12 rkn12_;
  Dop853 dop853_;
  std::optional<Ros34pw2> ros34pw2_;  ///< this and the next two: if there are matrices
  std::optional<FloatingFrame> floating_frame_;
  ImplicitWork implicit_;
  std::optional<ImplicitContact> implicit_contact_;
  Reach reach_;
  double fastest_damping_ = 0;   ///< largest damping / mass [1/s]
  Scalars time_scale_;           ///< (3 * points) position error that a velocity error amounts to [s]
  Scalars memory_;               ///< (3 * points) in which damping forgets an error [s]; infinite without damping
  State start_, coarse_, fine_;  ///< of the communication step; of trials
  Exchange start_exchange_, scratch_;
  Course trial_course_;
  Points x0_, v0_;
};

}  // namespace softffd
