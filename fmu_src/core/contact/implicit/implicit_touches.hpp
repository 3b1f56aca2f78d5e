/// What differs between the implicit steps (implicit_contact.hpp) of bodies whose control points meet planes (point_touches.hpp) and of
/// those whose surface does (surface_touches.hpp): what touches, and how touches and their forces follow from the linearised equations.
///
/// A step asks in this order, from the second line on as often as it takes:
///
///      open, guess             the planes of the step, and what touches at first
///      find_friction           friction at the displacements so far
///      solve                   one Newton step with its touches
///      add_forces              of the touches, for the balance
///      find_reactions, hold    what they have done, and what the next step begins with
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
    double loads_at;                ///< time of the outside forces [s]
    Factored* kept = nullptr;       ///< matrix of the steps before; null: none is kept
    const Points* along = nullptr;  ///< about the velocities at the end (points, 3) [m/s]; null: those of the rigid motion at the begin
    bool same_matrix = false;       ///< that of the step before may serve: the same body and h
    double way = 0;                 ///< by which the solution may be off [m]
    double accuracy = 1e-8;         ///< of the largest force: what may be left of a balance; rounding of the forces comes on top [1]
  };
  /// What one touch does to the body.
  struct Reaction {
    int plane, at;          ///< at: the control point or the sample
    Vec3 normal;            ///< of the plane
    Vec3 force;             ///< [N]
    bool first;             ///< of those at the same place
    int solid = -1;         ///< whose own sample it is (contact/free/solid_samples.hpp); -1: it is of the body
    Vec3 begin{}, place{};  ///< where it is when the step begins, and at its end
  };

  virtual ~ImplicitTouches() = default;

  virtual void open(const Step& step) = 0;
  virtual const HalfSpace& plane(int q) const = 0;  ///< at the end of the step
  /// Velocity of plane q's material at a place during the step, seen at mid-step [m/s].
  virtual Vec3 material_velocity(int q, const Vec3& x) const = 0;
  /// Is there room in front of all planes?
  virtual bool possible(const Vec3& x, double slack) = 0;
  /// May a pinned point be behind planes?
  virtual bool pins_pass() const = 0;
  /// What touches at first. force: from outside [N]; x: at the end, were there no contact.
  virtual void guess(const Step& step, const Points& force, const Points& x) = 0;

  /// Friction at displacements u of the step, `first` before the first solution. slight: a change of its stiffness that does not matter.
  virtual void find_friction(const Step& step, const Points& u, bool first, double largest_stiffness, double slight) = 0;
  /// The next solution is to start from new matrices.
  virtual void refresh() = 0;
  /// Masses, stiffness or damping have changed.
  virtual void forget_matrix() {}
  /// The next solution is to start from the matrix that is kept, of whatever step. Returns false if it cannot.
  virtual bool resume(const Step&) { return false; }
  /// The next solution may take the matrices as they are. slight: a change of friction's stiffness that does not matter [N/m].
  virtual void keep(double slight) = 0;
  /// Finds the solution and the touches with their forces; cautious: slower, but without circles. not_finite: there is none.
  virtual StepStatus solve(const StepProblem& problem, bool cautious) = 0;
  virtual StepSolution& solution() = 0;
  virtual const StepMatrix& matrix() const = 0;
  /// Those of samples' contact, beside factors and solutions; of control points next to none.
  virtual Operations& operations() { return none_; }
  /// f += forces of the touches [N].
  virtual void add_forces(Points& f) const = 0;
  virtual double largest_load() const = 0;

  /// Takes away what rounding has left of places behind planes.
  virtual void keep_in_front(const Body& body, Points& x) const = 0;
  virtual void find_reactions(std::vector<Reaction>& reactions) const = 0;
  /// The value of each control point, (points, 3), where this reaction acts.
  virtual Vec3 value(const Reaction& reaction, const Points& values) const = 0;
  virtual void hold(State& state) const = 0;

 private:
  Operations none_;
};

}  // namespace softffd
