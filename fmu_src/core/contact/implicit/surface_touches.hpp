/// Samples of the object's surface, or nodes of a solid, that meet planes, in implicit steps: none is behind a plane at the end of a step.
///
/// The linearised equations A dx = r + sum_s W_s f_s with as many forces as Coulomb's law and the planes take,
///
///      load n . f_s >= 0,  gap_s(x + dx) >= 0,  their product 0,       friction at most mu times the load, against the slip of the step.
///
/// Gaps and slips are linear in the control points; so the step's end obeys the law itself, not a linearisation of it, and no row enters A:
///
/// Without friction that minimises 1/2 dx . A dx - r . dx subject to the gaps (dual_active_set.hpp), in the metric of A
/// (step_delassus.hpp). With friction the same, at the friction at hand, says which rows are active; all forces of these follow together
/// (coulomb_rows.hpp); and again, until no sample is behind a plane.
///
/// What sticks ends the step where its plane's material has taken it, so that nothing creeps. Forces of the step before are where the next
/// one begins to look: at rest they are the solution. They belong to the state.
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
  Vec3 material_velocity(int q, const Vec3& x) const override { return middle_[q].material_velocity(x); }
  bool possible(const Vec3& x, double slack) override;
  bool pins_pass() const override { return true; }
  void guess(const Step& step, const Points& force, const Points& x) override;
  void find_friction(const Step&, const Points&, bool, double, double) override {}  // it follows from the forces
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
  void keep_in_front(const Body&, Points&) const override {}  // to rounding they are
  void find_reactions(std::vector<Reaction>& reactions) const override;
  Vec3 value(const Reaction& reaction, const Points& values) const override { return samples_.at(reaction.at, values); }
  void hold(State& state) const override;

 private:
  /// A row and the force on it [N].
  struct Force {
    SurfaceRow row;
    Vec3 force;
  };
  void linearise(const StepProblem& problem);
  bool solve_free(const StepProblem& problem);
  StepStatus find_forces(const StepProblem& problem);
  // what solids do to their samples
  void set_normals();
  int plane_of(int obstacle, int sample) const;
  void find_tangents(double way);
  void turn_tangents(const StepProblem& problem);
  bool tangents_stand(const StepProblem& problem) const;
  HalfSpace tangent_at(int plane, const Vec3& place) const;
  Count number(const SurfaceRow& row) const { return Count(obstacle_[row.plane]) * samples_.all() + row.sample; }
  /// Is it a row of a solid's own sample?
  bool own(const SurfaceRow& row) const { return !samples_.of_object(row.sample); }
  const Tangent& tangent_of(int plane) const { return tangents_.found()[plane - flat_]; }
  Vec3 begin_of(const SurfaceRow& row) const;
  Vec3 material_of(const SurfaceRow& row, const Points& x) const;
  SolidSample sample_of_row(const SurfaceRow& row, const Points& x) const;
  double way_of_free() const;
  void place_free(const Points& x);
  void find_lack();
  StepStatus press(const StepProblem& problem, bool& lost);
  void find_loads();
  bool in_front(double slack);
  bool take_loads();
  bool rub(const StepProblem& problem);
  bool rubs() const;
  void find_move(const std::vector<Force>& forces);
  void find_heights(const StepProblem& problem);
  void list_candidates();
  bool all_covered();
  Vec3 place(const StepProblem& problem, const SurfaceRow& row) const;

  const Samples& samples_;
  double length_;
  std::vector<HalfSpace> middle_, end_;  ///< the obstacles in the middle and at the end of the step
  std::vector<SolidPose> poses_;         ///< of solids, at the end
  FreeRows free_rows_;
  std::vector<FreeState> free_bodies_;  ///< at the end, by the forces at the linearisation
  Tangents tangents_;
  int flat_ = 0;                   ///< number of half-spaces, which come first; then planes of the tangents, one each
  std::vector<HalfSpace> planes_;  ///< at the end of the step
  std::vector<int> obstacle_;      ///< (planes) whose plane it is
  std::vector<double> friction_;   ///< (planes) coefficients
  std::vector<Vec3> own_;          ///< (planes) place of a solid's own sample
  std::vector<Vec3> normals_;      ///< (planes)
  const Step* step_ = nullptr;     ///< that is open
  bool covered_ = true;            ///< no other sample can have come to a solid
  SampleSearch search_;
  StepMatrix matrix_;
  DualActiveSetIn<StepDelassus> set_;
  CoulombRows<Eigen::Matrix3d> rows_;
  CoulombRows<Eigen::Matrix3d>::Problem coulomb_;
  std::vector<Force> forces_, before_, active_;  ///< of the rows, sorted; before: at the linearisation
  std::vector<SurfaceRow> start_;                ///< rows that are loaded already
  std::vector<double> loads_;                    ///< theirs [N]
  StepSolution solution_;
  Points free_, move_;  ///< dx with the forces before; with those at hand [m]
  std::vector<GapFunction> gap_functions_;
  std::vector<Candidate> candidates_;
  FeasibleSet feasible_;
  double doubt_ = 0;                      ///< rounding of move_ [m]
  std::vector<Wrench> placed_by_, lack_;  ///< by which the free bodies were placed, and what the forces there are beyond it
  bool stale_ = true;
  bool resumed_ = false;  ///< the next matrix is that which is kept
  Factored made_;         ///< what the one at hand was made from
};

}  // namespace softffd
