/// Samples of the object's surface, or nodes of a solid, that meet planes in implicit steps: none is behind a plane at the end of a step.
///
/// The linearised equations A dx = r + sum_s W_s f_s are solved with the forces that Coulomb's law and the planes require,
///
///      load n . f_s >= 0,  gap_s(x + dx) >= 0,  their product 0,       friction at most mu times the load, against the slip of the step.
///
/// Gaps and slips are linear in the control points. The end of the step therefore obeys the law itself, not a linearisation of it, and no
/// contact constraint enters A.
///
/// Without friction, the solution minimises 1/2 dx . A dx - r . dx subject to the gaps (dual_active_set.hpp), in the metric of A
/// (step_delassus.hpp). With friction, the same minimisation at the present friction tells which contact constraints are active; then all
/// their forces are found together (coulomb_rows.hpp). Both are repeated until no sample is behind a plane.
///
/// A sticking sample ends the step where the material of its plane has taken it, so that nothing creeps. The forces of the step before are
/// the warm start of the next one; at rest they are the solution. They belong to the state.
#pragma once
#include "contact/coulomb_rows.hpp"
#include "contact/feasible.hpp"
#include "contact/implicit/implicit_touches.hpp"
#include "contact/implicit/step_delassus.hpp"
#include "contact/surface/dual_active_set.hpp"
#include "contact/surface/sample_search.hpp"
#include "contact/surface/tangents.hpp"

namespace softffd {

class SurfaceTouches final : public ImplicitTouches {
 public:
  SurfaceTouches(const Samples& samples, double length, int planes);

  void open(const Step& step) override;
  const HalfSpace& plane(int q) const override { return end_[q]; }
  Vec3 material_velocity(int q, const Vec3& x) const override { return seen_[q].material_velocity(x); }
  bool possible(const Vec3& x, double slack) override;
  bool pins_pass() const override { return true; }
  void guess(const Step& step, const Points& force, const Points& x) override;
  bool find_friction(const Step&, const Points&, bool, double, double) override { return true; }  // friction follows from the forces
  void refresh() override;
  void forget_matrix() override { made_ = {}; }
  bool resume(const Step& step) override;
  void keep(double) override {}
  StepStatus solve(const StepProblem& problem, bool cautious) override;
  StepSolution& solution() override { return solution_; }
  const StepMatrix& matrix() const override { return matrix_; }
  Operations& operations() override { return set_.delassus().operations(); }
  void add_forces(Points& f) const override;
  double largest_load() const override;
  void keep_in_front(const Body&, Points&) const override {}  // samples are in front, to rounding
  void find_reactions(std::vector<Reaction>& reactions) const override;
  Vec3 value(const Reaction& reaction, const Points& values) const override { return samples_.at(reaction.at, values); }
  void hold(State& state) const override;

 private:
  /// A contact constraint and its force [N].
  struct Force {
    SurfaceRow row;
    Vec3 force;
  };
  void linearise(const StepProblem& problem);
  bool solve_free(const StepProblem& problem);
  StepStatus find_forces(const StepProblem& problem);
  // samples at solids, solid_touches.cpp
  void set_normals();
  int plane_of(int obstacle, int sample) const;
  void find_tangents(double way);
  void turn_tangents(const StepProblem& problem);
  bool tangents_stand(const StepProblem& problem) const;
  HalfSpace tangent_at(int plane, const Vec3& place) const;
  Count number(const SurfaceRow& row) const { return Count(obstacle_[row.plane]) * samples_.all() + row.sample; }
  /// True if the contact constraint is of a solid's own sample.
  bool own(const SurfaceRow& row) const { return !samples_.of_object(row.sample); }
  const Tangent& tangent_of(int plane) const { return tangents_.found()[plane - flat_]; }
  Vec3 begin_of(const SurfaceRow& row) const;
  Vec3 material_of(const SurfaceRow& row, const Points& x) const;
  SolidSample sample_of_row(const SurfaceRow& row, const Points& x) const;
  double way_of_free() const;
  void place_free(const Points& x);
  void find_lack();
  StepStatus solve_normal_forces(const StepProblem& problem, bool& lost);
  void find_loads();
  bool in_front(double slack);
  bool take_loads();
  bool solve_friction(const StepProblem& problem);
  bool has_friction() const;
  void find_move(const std::vector<Force>& forces);
  void find_gaps(const StepProblem& problem);
  void list_candidates();
  bool all_covered();
  Vec3 place(const StepProblem& problem, const SurfaceRow& row) const;

  const Samples& samples_;
  double length_;
  std::vector<HalfSpace> seen_, end_;  ///< obstacles when contact sees their velocities, and at the end of the step
  std::vector<SolidPose> poses_;       ///< of solids, at the end of the step
  FreeRows free_rows_;
  std::vector<FreeState> free_bodies_;  ///< at the end of the step, with the forces at the linearisation
  Tangents tangents_;
  int flat_ = 0;                   ///< number of half-spaces, which are the first planes; the others are those of `tangents_`
  std::vector<HalfSpace> planes_;  ///< at the end of the step
  std::vector<int> obstacle_;      ///< (planes) number of the obstacle
  std::vector<double> friction_;   ///< (planes) coefficients
  std::vector<Vec3> own_;          ///< (planes) place of a solid's own sample
  std::vector<Vec3> normals_;      ///< (planes)
  const Step* step_ = nullptr;     ///< the open step
  bool covered_ = true;            ///< no sample beside those in `tangents_` can have come to a solid
  SampleSearch search_;
  StepMatrix matrix_;
  DualActiveSetIn<StepDelassus> set_;
  CoulombRows<Eigen::Matrix3d> rows_;
  CoulombRows<Eigen::Matrix3d>::Problem coulomb_;
  std::vector<Force> forces_, before_, active_;  ///< of the contact constraints, sorted; before_: at the linearisation
  std::vector<SurfaceRow> start_;                ///< contact constraints that are loaded already
  std::vector<double> loads_;                    ///< of the constraints in start_ [N]
  StepSolution solution_;
  Points free_, move_;  ///< dx with the forces before_; dx with the present forces [m]
  std::vector<GapFunction> gap_functions_;
  std::vector<Candidate> candidates_;
  FeasibleSet feasible_;
  double doubt_ = 0;                      ///< rounding error of move_ [m]
  std::vector<Wrench> placed_by_, lack_;  ///< wrenches that placed the free bodies; what the present forces there exert beyond them
  bool stale_ = true;
  bool resumed_ = false;  ///< the next matrix is the kept one
  Factored made_;         ///< what the present matrix was made from
};

}  // namespace softffd
