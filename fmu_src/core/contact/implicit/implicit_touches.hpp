/// Interface of the two kinds of contact in implicit steps (implicit_contact.hpp): planes meet the control points of a body
/// (point_touches.hpp), or samples of its surface (surface_touches.hpp). The kinds differ in what touches, and in how touches and their
/// forces follow from the linearised equations.
///
/// A step calls these functions in this order, from the second line on as often as needed:
///
///      open, guess             sets the planes of the step; guesses what touches at first
///      find_friction           computes friction at the displacements so far
///      solve                   takes one Newton step with its touches
///      add_forces              adds the forces of the touches, for the balance
///      find_reactions, hold    report what the touches have done; store what the next step begins with
#pragma once
#include <vector>

#include "body/equations.hpp"
#include "contact/implicit/step_matrix.hpp"
#include "contact/operations.hpp"
#include "model/state.hpp"

namespace softffd {

class ImplicitTouches {
 public:
  struct Step {
    const Equations& equations;
    double t, h;  ///< [s]
    const State& from;
    double loads_at;                ///< time at which the outside forces are taken [s]
    Factored* kept = nullptr;       ///< matrix of the steps before; null: none is kept
    const Points* along = nullptr;  ///< approximate velocities at the end (points, 3) [m/s]; null: those of the rigid motion at the start
    bool same_matrix = false;       ///< the matrix of the step before may serve: body and h are the same
    double way = 0;                 ///< distance by which the solution may be off [m]
    double accuracy = 1e-8;         ///< allowed residual of the balance over the largest force [1]; rounding of the forces comes on top
    bool turned = false;            ///< `along` has turned to the end of the step already
    double seen = 0.5;              ///< part of the step after which contact sees velocities of obstacles [1]: 1 in stages of SDIRK2
  };
  /// Action of one touch on the body.
  struct Reaction {
    int plane, at;          ///< at: number of the control point or the sample
    Vec3 normal;            ///< of the plane
    Vec3 force;             ///< [N]
    bool first;             ///< it is the first of those at the same place
    int solid = -1;         ///< solid whose own sample it is at (contact/free/solid_samples.hpp); -1: it is at the body
    Vec3 begin{}, place{};  ///< place of the sample at the start of the step and at its end [m]
  };

  virtual ~ImplicitTouches() = default;

  virtual void open(const Step& step) = 0;
  virtual const HalfSpace& plane(int q) const = 0;  ///< at the end of the step
  /// Velocity of plane q's material at x, in the pose that the plane has when it is seen [m/s].
  virtual Vec3 material_velocity(int q, const Vec3& x) const = 0;
  /// True if some position is in front of all planes, to within `slack` [m].
  virtual bool possible(const Vec3& x, double slack) = 0;
  /// True if pinned points may be behind planes.
  virtual bool pins_pass() const = 0;
  /// Guesses what touches at first. force: from outside [N]; x: positions at the end of the step without contact [m].
  virtual void guess(const Step& step, const Points& force, const Points& x) = 0;

  /// Computes friction at displacements u of the step. first: no solution yet. slight: a stiffness change that does not matter [N/m].
  /// Returns false if contacts have begun or ceased to slide, or friction has changed much, since the last solution.
  virtual bool find_friction(const Step& step, const Points& u, bool first, double largest_stiffness, double slight) = 0;
  /// Makes the next solution start from new matrices.
  virtual void refresh() = 0;
  /// Call when masses, stiffness or damping have changed.
  virtual void forget_matrix() {}
  /// Makes the next solution start from the kept matrix, whichever step it is from. Returns false if that is impossible.
  virtual bool resume(const Step&) { return false; }
  /// Lets the next solution use the present matrices. slight: a change of friction's stiffness that does not matter [N/m].
  virtual void keep(double slight) = 0;
  /// Finds the solution, and the touches with their forces. cautious: slower, but not in circles. not_finite: there is no solution.
  virtual StepStatus solve(const StepProblem& problem, bool cautious) = 0;
  virtual StepSolution& solution() = 0;
  virtual const StepMatrix& matrix() const = 0;
  /// Operations that contact of samples takes, factorizations and solutions not counted; contact of control points takes next to none.
  virtual Operations& operations() { return none_; }
  /// f += forces of the touches [N].
  virtual void add_forces(Points& f) const = 0;
  virtual double largest_load() const = 0;

  /// Moves places in front of the planes that rounding has left behind them.
  virtual void keep_in_front(const Body& body, Points& x) const = 0;
  virtual void find_reactions(std::vector<Reaction>& reactions) const = 0;
  /// Value of a field of the control points, (points, 3), at the place where this reaction acts.
  virtual Vec3 value(const Reaction& reaction, const Points& values) const = 0;
  virtual void hold(State& state) const = 0;

 private:
  Operations none_;
};

}  // namespace softffd
