/// Decides which method takes a sub-interval of time, in what kind of steps, and why: decisions without any physics. The caller gathers the
/// facts. Some facts cost work and some change what is remembered (the stability bound), so that a plan that lacks one asks for it:
///
///      facts -> plan: wants `reach` -> facts with reach -> plan: bm4, fitted steps; if they come upon an obstacle
///            -> facts with that -> plan: wants `stiffness` -> ... -> plan: leapfrog, doubled steps
///
/// Thresholds are in thresholds.hpp, the methods' own numbers in methods/traits.cpp.
#pragma once
#include <optional>

#include "model/run.hpp"

namespace softffd {

/// What is known about the sub-interval that lies ahead.
struct Facts {
  Method asked = Method::automatic;
  bool given_step = false;             ///< the user gives the internal step
  double length = 1;                   ///< length of the run, in sub-intervals like this one
  bool counted = false;                ///< the sub-interval is a whole number of given steps
  bool damped = false;                 ///< any damping
  bool dashpots = false;               ///< internal damping
  bool obstacles = false;              ///< the scene has planes
  bool surface = false;                ///< samples of the surface meet the planes
  bool pins = false;                   ///< the scene has pins
  bool explicit_alone = false;         ///< implicit methods and modes have no matrices for the body
  std::optional<bool> clear{};         ///< no point is on an obstacle now
  std::optional<bool> within_reach{};  ///< a point could come to an obstacle, by forecast
  std::optional<double> stiffness{};   ///< number of largest stable leapfrog steps in the sub-interval
  bool came_upon_obstacle = false;     ///< a method that does not know obstacles has come upon one
  std::optional<bool> rings{};         ///< the body's modes can carry its motion
};

enum class Want { nothing, clear, within_reach, stiffness, rings };
enum class Steps {
  counted,     ///< given steps, counted
  fitted,      ///< steps of one size, as long as stability and tolerance allow, or given steps that do not divide the sub-interval
  controlled,  ///< under error control
  doubled,     ///< step doubling: every sub-interval is run twice
  implicit,    ///< implicit steps as they are given, or one for each sub-interval
  damped,      ///< SDIRK2 under error control, explicit steps where implicit ones do not pay
  impacts,     ///< flights, explicit steps through impacts, implicit steps at rest
  by_trials    ///< by the method that trial runs find, fitted or controlled
};
/// What causes a rollback to the beginning of the sub-interval, which is then planned again.
enum class Rollback { never, from_obstacle };

struct Plan {
  Want want = Want::nothing;  ///< the fact that is missing; nothing: the rest is the plan
  Method method = Method::automatic;
  Steps steps = Steps::fitted;
  Reason reason = Reason::asked;
  Rollback rollback = Rollback::never;
  bool rings = false;  ///< for impacts: the motion has just been found to be carried by the body's modes
};

Plan plan(const Facts& facts);

/// True if every given step decides for itself whether an obstacle is within reach, so that dividing the time changes nothing.
bool plans_every_given_step(const Facts& facts);

// ---- trial runs: which method needs the least work for what is left of a communication step ----

/// True if implicit steps are worth a trial at all. H_omega: length of the sub-interval in units of 1 / omega, by the bound.
bool implicit_may_pay(double H_omega);
/// The implicit method to try: the one in the body's frame if the other would have to cut its steps because the body turns.
Method implicit_method(bool pins, double H_omega, bool turning_cuts);
/// True if implicit steps of this work could win against leapfrog.
bool implicit_may_win(double work, double leapfrog_least);
/// True if a vibration [m] is so large that implicit steps must not pass over it.
bool too_loud(double vibration, double tolerance);
/// True if the difference [m] between an implicit step and explicit ones is small enough for implicit steps.
bool quiet(double difference, double tolerance);

/// Work of the candidates, as found so far; infinite for a candidate that is out of the question.
struct Candidates {
  Method before = Method::automatic;  ///< the last trial runs' winner
  double least = 0;                   ///< leapfrog's work at its stability limit
  Method implicit = Method::automatic;
  double implicit_work;
  double leapfrog;
  Method adaptive = Method::automatic;
  double adaptive_work;
  double bm4;
  Candidates();
};
struct Winner {
  Method method;
  double work;
  Reason reason;
};
Winner best_of(const Candidates& candidates);
/// True if leapfrog at its stability limit, or nearly there, is accurate enough.
bool leapfrog_is_enough(const Candidates& candidates);

}  // namespace softffd
