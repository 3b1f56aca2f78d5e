/// Which method takes a stretch of time, in what kind of steps, and why: decisions without any physics. Whoever steps gathers the facts;
/// some cost something and some change what is remembered (the stability bound), so that a plan that lacks one asks for it:
///
///      facts -> plan: wants `reach` -> facts with reach -> plan: bm4, fitted steps; if they come upon an obstacle
///            -> facts with that -> plan: wants `stiffness` -> ... -> plan: leapfrog, doubled steps
///
/// Thresholds are in thresholds.hpp, the methods' own numbers in methods/traits.cpp.
#pragma once
#include <optional>

#include "model/run.hpp"

namespace softffd {

/// What is known of a stretch of time that lies ahead.
struct Facts {
  Method asked = Method::automatic;
  bool given_step = false;             ///< the user gives the internal step
  double length = 1;                   ///< of the run, in stretches
  bool counted = false;                ///< and the stretch is a whole number of it
  bool damped = false;                 ///< any damping
  bool dashpots = false;               ///< of them, internal damping
  bool obstacles = false;              ///< the scene has planes
  bool surface = false;                ///< which samples of the surface meet
  bool pins = false;                   ///< the scene has pins
  bool explicit_alone = false;         ///< implicit methods and modes have no matrices for the body
  std::optional<bool> clear{};         ///< no point is on an obstacle now
  std::optional<bool> within_reach{};  ///< a point could come to an obstacle, by forecast
  std::optional<double> stiffness{};   ///< largest stable leapfrog steps in the stretch
  bool came_upon_obstacle = false;     ///< a method that does not know obstacles has
  std::optional<bool> rings{};         ///< the body's modes can carry its motion
};

enum class Want { nothing, clear, within_reach, stiffness, rings };
enum class Steps {
  counted,     ///< given ones, counted
  fitted,      ///< of one size, as long as stability and tolerance let them be, or given ones that do not divide the stretch
  controlled,  ///< under error control
  doubled,     ///< every stretch run twice
  implicit,    ///< implicit ones as they are given, or one for each stretch
  damped,      ///< SDIRK2 under error control, explicit ones where those do not pay
  impacts,     ///< flights, explicit steps through impacts, implicit ones at rest
  by_trials    ///< by the method that trial runs find, fitted or controlled
};
/// What sends a stretch back to its beginning, to be planned again.
enum class Rollback { never, from_obstacle };

struct Plan {
  Want want = Want::nothing;  ///< the fact that is missing; nothing: the rest is the plan
  Method method = Method::automatic;
  Steps steps = Steps::fitted;
  Reason reason = Reason::asked;
  Rollback rollback = Rollback::never;
  bool rings = false;  ///< of impacts: the motion has just been found to be carried by the body's modes
};

Plan plan(const Facts& facts);

/// Does every given step decide for itself whether an obstacle is within reach? So that cutting the time changes nothing.
bool plans_every_given_step(const Facts& facts);

// ---- trial runs: which method needs the least work for what is left of a communication step ----

/// Is it worth trying implicit steps at all? H_omega: length in units of 1 / omega, the bound.
bool implicit_may_pay(double H_omega);
/// The implicit method: the one in the body's frame where the other would have to cut its steps because the body turns.
Method implicit_method(bool pins, double H_omega, bool turning_cuts);
/// Could so much work of implicit steps win against leapfrog's?
bool implicit_may_win(double work, double leapfrog_least);
/// Is a vibration [m] so large that implicit steps must not pass over it?
bool too_loud(double vibration, double tolerance);
/// Is a difference [m] between an implicit step and explicit ones small enough for it?
bool quiet(double difference, double tolerance);

/// Work of the candidates, as found so far; infinite where one is out of the question.
struct Candidates {
  Method before = Method::automatic;  ///< the last trial runs' winner
  double least = 0;                   ///< leapfrog's at its stability limit
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
Winner settle(const Candidates& candidates);
/// Is leapfrog at its stability limit, or nearly, accurate enough?
bool leapfrog_is_enough(const Candidates& candidates);

}  // namespace softffd
