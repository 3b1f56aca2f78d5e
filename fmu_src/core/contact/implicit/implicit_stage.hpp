/// One implicit step with exact contact, either a step of backward Euler or a stage of a second-order method:
///
///      M (v1 - v0) / h = internal forces(x1) + outside forces - D v1 - C(x1) v1 + contact(x1),      v1 = (x1 - x0) / h,
///
/// At x1 no control point, or no sample of the surface, is behind a plane; loads only push; friction obeys Coulomb's law.
///
/// The equations are solved by Newton's method, which starts from the motion that the body would have without forces. Three measures make
/// it converge in two or three iterations where the springs are stiff:
///   - the rotation in each Newton step is carried out as a rotation (rigid_motion.hpp); a straight motion would stretch the springs;
///   - touches and loads are exact for the linearised equations (linear_contact.hpp; for samples and nodes of a solid surface_touches.hpp),
///     friction and loads together;
///   - the first guess of the loads assumes that the points on planes are in equilibrium: at rest and in steady sliding it is the solution.
/// The factor is kept while each change is at most a tenth of the change before.
///
/// The impulses that are reported for the planes are the momentum that the body lost, to rounding.
#pragma once
#include <memory>

#include "contact/implicit/convergence.hpp"
#include "contact/implicit/implicit_touches.hpp"
#include "contact/slip.hpp"

namespace softffd {

class ImplicitStage {
 public:
  using Step = ImplicitTouches::Step;
  using Reaction = ImplicitTouches::Reaction;

  /// samples: points of the surface that planes meet; null: planes meet the control points, or a solid's nodes, as samples of weight 1.
  ImplicitStage(const Lattice& lattice, int planes, const Samples* samples);

  /// Call when masses, stiffness or damping change.
  void body_changed() {
    largest_stiffness_ = -1;
    touches_->forget_matrix();
  }
  /// Solves the step; step.from.spring are the internal forces at step.from.x. not_finite: there was no solution, or none within the
  /// limits on factorizations, solutions and operations.
  StepStatus solve(const Step& step);
  void limit(Count factorizations, double solutions, double operations) {
    last_factorization_ = factorizations, last_solution_ = solutions;
    touches_->operations().allow(operations);
  }
  bool spent() const { return factorizations() >= last_factorization_ || solutions() >= last_solution_ || touches_->operations().spent(); }

  /// State at the end of the step, exactly in front of the planes; spring: the internal forces there [N].
  Points x, v, spring;
  std::vector<FreeState> free;
  /// Outside forces of the step [N].
  const Points& force() const { return force_; }
  const std::vector<Reaction>& reactions() const { return reactions_; }
  const ImplicitTouches& touches() const { return *touches_; }
  /// Samples that obstacles meet; null: they meet the points of the lattice.
  const Samples* samples() const { return samples_; }
  /// Rounding error of an energy [J].
  double noise() const { return noise_ * extent_; }

  /// Work of planes and pins on the body [J].
  double contact_work(const Step& step) const;
  /// The part of the contact work that free bodies do, as they move from the start of the step to its end [J].
  double work_of_free(const Step& step) const;
  /// `work`, that of planes and pins, plus that of friction along the slip, taken at the mean of the velocities before and after [J].
  double given_by_contacts(const Step& step, double work) const;
  /// Hash of the contacts at the end of the step and of which of them slide: another set has another number.
  Count constraints() const { return constraints_; }
  /// Power that dampers and friction take at the end of the step [W].
  double lost_power(const Step& step) const;
  /// True if an obstacle stops a place that was off it at the start of the step, or touched it and was approached by it.
  bool strikes(const Step& step) const;
  /// Slip of the contacts in the step; step.from is the state where the slip began.
  Slip slip_of_contacts(const Step& step) const;
  /// Adds `weight` times the impulses on planes and pins.
  void book(const Step& step, double weight, Exchange& exchange) const;

  Count iterations() const { return iterations_; }
  Count factorizations() const { return touches_->matrix().factorizations(); }
  double operations() const { return touches_->operations().done(); }  ///< since the limit
  double solutions() const { return touches_->matrix().solutions(); }  ///< as LatticeMatrix counts them

 private:
  StepStatus open(const Step& step);
  void predict(const Step& step);
  StepStatus iterate(const Step& step);
  bool find_residual(const Step& step, bool first);
  bool in_balance(const Step& step);
  void move(const Step& step);
  void keep_converging();
  void close(const Step& step);
  bool presses_solids(const Step& step) const;
  void spread_rounding(const Step& step);
  void push_free(const Step& step);
  void place_pins(const Step& step);
  Frame frame_of(const Step& step, const Pin& pin) const;
  void open_parts(const Step& step);
  void place_part(const Step& step, const FreeMotion& body, const FreePart& part);
  void find_parts_residual(const Step& step);
  double move_parts(const Step& step, const Points& change);
  bool parts_in_balance(double slack) const;
  HalfSpace begin_of(const Step& step, int obstacle, const Vec3& place) const;
  Vec3 material_velocity(const Step& step, const Reaction& at) const;
  Vec3 impulse(const Step& step, const Reaction& reaction) const;
  SolidPose pose_of(const Step& step, int obstacle, bool at_end) const;
  Vec3 place_at_begin(const Step& step, const Reaction& at) const;
  Vec3 velocity_at_begin(const Step& step, const Reaction& at) const;
  Vec3 velocity_at_end(const Step& step, const Reaction& at) const;
  /// Action of a reaction at a solid's own sample on the free one of the two obstacles.
  struct OnFree {
    int other;     ///< number of the obstacle that is not free
    Vec3 impulse;  ///< on the free one [N s]
    double work;   ///< work of the other's own motion on the free one [J]
  };
  OnFree on_free(const Step& step, const Reaction& at) const;
  static double friction_of(const Step& step, const Reaction& at);
  Vec3 place_at_end(const Reaction& at) const;
  static bool on_body(const Reaction& reaction) { return reaction.solid < 0; }
  Vec3 pin_impulse(const Step& step, int p) const;

  std::unique_ptr<const Samples> nodes_;
  const Samples* samples_;
  std::unique_ptr<ImplicitTouches> touches_;
  std::vector<Reaction> reactions_;  ///< in the step that was solved
  std::vector<FreePart> parts_;      ///< parts of free pins, at their present places
  Scalars diagonal_;                 ///< (points) part of the inertia and the damping in the matrix [N/m]
  Points u_;                         ///< displacement in the step
  Points force_, residual_, last_change_, scratch_;
  double largest_stiffness_ = -1, force_scale_ = 0, noise_ = 0, extent_ = 0, slight_ = 0;
  Convergence convergence_;
  double matrix_h_ = 0;    ///< step length that the matrix is made for [s]
  bool straight_ = false;  ///< the last Newton step was taken as the linear equations give it
  Vec3 rounding_ = Vec3::Zero();
  Count constraints_ = 0, iterations_ = 0, last_factorization_ = 0;
  double last_solution_ = 0;
};

}  // namespace softffd
