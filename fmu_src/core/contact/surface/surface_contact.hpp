/// Explicit contact of the object's own surface with obstacle planes: no sample of the surface is behind a plane at the end of any
/// internal step. Control points may be.
///
/// The gap of a sample is linear in the control points, n . Q_s(x) - c with Q_s(x) = sum W_si x_i. The action of the obstacles is
/// therefore one convex problem of the whole body (surface_stage.hpp), solved twice a step as in contact of control points (contact.hpp):
///
///      drift   x1 = x0 + h v is moved to the nearest body that no plane cuts, in the metric of the masses; v changes by that move over h
///      close   the velocities after the closing half kick are changed likewise, for the samples that touch a plane at t1
///
/// A sample that arrives at the fraction th of the step gets (1 - th) of its impulse at the drift and the rest at the closing, which is
/// second order. Friction brakes only the slip after the impact: at the drift an arriving sample is to stick where it would be if it
/// had slid freely until the impact,
///
///      target = Q_s(x0) + h w + th (its free slip),      for a sample that was on the plane at t0: th = 0,
///
/// with the velocity w of the obstacle's material. A sticking sample stays at its target, so that nothing creeps. Contact adds no kinetic
/// energy on planes at rest: if th made it add any, the stage is solved again with th = 0.
///
/// The active contact constraints and their friction are the warm start of the next step; they belong to the state (model/run.hpp). While
/// a body rests, rolls or sways on one plane, they remain the solution in nearly every step (surface_warm_start.cpp). The closing starts
/// with the constraints of the drift: among crowded samples many others would carry the body as well, but friction on those others could
/// not hold what the constraints of the drift hold.
#pragma once
#include "contact/pin_impulses.hpp"
#include "contact/surface/sample_rows.hpp"
#include "contact/surface/sample_search.hpp"
#include "contact/surface/surface_stage.hpp"
#include "contact/surface/tangents.hpp"
#include "model/run.hpp"

namespace softffd {

inline double largest_speed(const Points& v) { return kernels::largest(v.size(), v.data()); }

class SurfaceContact {
 public:
  SurfaceContact(const Body& body, int planes);

  /// Moves the body out of planes at a communication point; velocities stay. If nothing is pinned and that suffices, the body is moved as
  /// a whole; what is left is pushed in. Sets `moved` if anything has moved.
  StepStatus clear_jumps(const Body& body, const Drive& around, double time, Points& x, bool& moved);
  /// Moves free obstacles out of other obstacles likewise.
  StepStatus clear_free_jumps(const Drive& around, double time, std::vector<FreeState>& free, bool& moved) {
    return tangents_.move_out(around, time, free, moved);
  }
  /// Counts the samples on each plane.
  void count(const Drive& around, double time, const Points& x, std::vector<Count>& contacts);

  /// Prepares steps of size h from t0 on, with these half kicks.
  void begin(const Body& body, const HalfKicks& kicks, const Drive& around, double t0, double h);
  /// After `begin`, if `hold` is to act on the first kick: finds the samples that touch an obstacle at x.
  void look(const Drive& around, double time, const Points& x);
  /// Finds out whether the free drift to x1 may bring the surface to an obstacle. rows: of the state.
  void find(const StepView& step, const Points& x1, const SurfaceRows& rows);
  /// After `find`: correct x1 and v, then v after the closing half kick, as in contact.hpp. free: the free bodies at the start of the
  /// step. They are changed to what they are at its end, by flight, obstacles and contact.
  StepStatus drift(const StepView& step, const Points& before, Points& v, Points& x1, SurfaceRows& rows, std::vector<FreeState>& free,
                   Exchange& exchange);
  StepStatus close(const StepView& step, Points& v, SurfaceRows& rows, std::vector<FreeState>& free, Exchange& exchange);
  /// Returns the energy that contact took in the step that `close` has ended, less the work of the prescribed motion of the obstacles
  /// [J], for the kicks of kick.hpp. v1: velocities at the end of the step.
  double loss(const StepView& step, const Points& v1) const;
  /// Returns the part of this energy that comes from the points of free pins [J].
  double loss_of_free_pins(const StepView& step, const Points& v1) const;
  /// True if `loss` is wanted. Otherwise nothing is stored for it.
  static bool wants_loss(const StepView& step) { return step.around.watch || !step.body.damped; }
  /// True if there is anything for `hold` to do. Otherwise `hold` would leave all velocities as they are.
  bool lasts(const SurfaceRows& rows) const { return !lasting_.empty() || (!rows.close.empty() && rows.close[0] >= 0); }
  /// Projects the velocities so that samples stick that touch an obstacle both at the start of the step and after its drift. Nothing else
  /// changes.
  StepStatus hold(const StepView& step, Points& v, const SurfaceRows& rows, const std::vector<FreeState>& free) {
    set_free(step.around, free, step.x0);
    return stop(lasting_, step, v, rows);
  }

  /// True if `find` has found anything near an obstacle.
  bool near() const { return near_; }
  /// True if any sample touches a plane after the last drift.
  bool touched() const { return !touching_.empty(); }
  Count impacts() const { return impacts_; }

  /// Limits the work from here on, in evaluations of the spring forces. A step that exceeds it is given up. `work` is what has been done.
  void allow(double most);
  double work() const;
  bool spent() const { return !(work() <= most_); }

 private:
  using Slip = std::function<Vec3(const SurfaceRow&)>;
  /// Returns the number by which the state identifies a row. Numbers are in the order of the rows: solids' own samples come last.
  Count number(const SurfaceRow& row) const {
    return Count(obstacle_[row.plane] + (samples_.of_object(row.sample) ? 0 : still_.size())) * samples_.all() + row.sample;
  }
  /// Returns the row with the number of its obstacle as its plane. For a solid's own sample this plane is no obstacle's.
  SurfaceRow row_of(Count number) const { return {int(number / samples_.all()), int(number % samples_.all())}; }
  void load(const std::vector<Count>& numbers, const Points& friction, SurfaceStage& stage) const;
  void save(const SurfaceStage& stage, std::vector<Count>& numbers, Points& friction) const;
  void set_planes();
  void set_free(const Drive& around, const std::vector<FreeState>& free, const Points& x);
  void give_free(const SurfaceStage& stage, const Drive& around, double rate, bool move, std::vector<FreeState>& free) const;
  bool lift_tangents(const StepView& step, const Points& x1, const std::vector<FreeState>& free);
  bool lift(const StepView& step, int i, const std::vector<FreeState>& moved, double slack);
  double obstacles_way(const Drive& around) const;
  double book_own(const StepView& step, const SurfaceRow& row, const Vec3& place, const Vec3& impulse, Exchange& exchange);
  void book_free(const StepView& step, const std::vector<FreeState>& free, Exchange& exchange) const;
  void move_planes(const StepView& step);
  bool find_gaps(const Points& x1);
  void search(int q, const Scalars& gaps, double way);
  double slack_of_rows() const;
  StepStatus fit(const std::vector<Count>& rows, const Points& friction, double way, const Slip& slip);
  bool sticks() const;
  StepStatus stop(const std::vector<Candidate>& candidates, const StepView& step, Points& v, const SurfaceRows& rows);
  StepStatus find_stop(const std::vector<Candidate>& candidates, const StepView& step, const Points& v, const SurfaceRows& rows);
  void divide_work(SurfaceStage& stage);
  StepStatus position_stage(const StepView& step, const Points& v, const Points& x1, const SurfaceRows& rows);
  StepStatus solve_near(const StepView& step, const Points& v, const Points& x1, const SurfaceRows& rows);
  Vec3 aim(const StepView& step, const Vec3& free, const SurfaceRow& row, bool at_once);
  bool gains(const StepView& step, const Points& x1) const;
  void find_places(const SurfaceStage& stage, const Points& x1);
  /// True if the sample of the row is a solid's own.
  bool own(const SurfaceRow& row) const { return !samples_.of_object(row.sample); }
  const Tangent& tangent_of(const SurfaceRow& row) const { return tangents_.found()[row.plane - flat_]; }
  /// Returns the place of a row's sample at the time of x0, which is t0 or t1; and its place at t1 without contact.
  Vec3 begin_of(const SurfaceRow& row, const Points& x0) const { return own(row) ? tangent_of(row).place : samples_.at(row.sample, x0); }
  Vec3 flown_of(const SurfaceRow& row, const Points& x1) const { return own(row) ? tangent_of(row).flown : samples_.at(row.sample, x1); }
  Vec3 velocity_of(const SurfaceRow& row, const Points& v) const {
    return own(row) ? tangent_of(row).velocity : samples_.at(row.sample, v);
  }
  void find_speeds(const Points& v, int but = -1);
  double book(const StepView& step, const SurfaceStage& stage, double per_force, Exchange& exchange);
  double give_pins(const StepView& step, const SurfaceStage& stage, double per_force, Exchange& exchange);
  // surface_warm_start.cpp
  bool recall(const std::vector<Count>& numbers, SurfaceStage& stage) const;
  bool warm_start_drift(const StepView& step, const Points& v, const Points& x1, const SurfaceRows& rows);
  bool warm_start_free_drift(const StepView& step, const Points& x1, const SurfaceRows& rows);
  bool warm_start_free_close(const StepView& step, const Points& v);
  bool list_warm_started(double h, const Points& v);
  bool warm_start_close(const StepView& step, const Points& v, const std::vector<Candidate>& candidates);
  bool fit_known(const std::vector<Count>& rows, const Points& friction, double tolerance, const Slip& slip);
  bool find_stop_of_known(const StepView& step, const Points& v, const SurfaceRows& rows);
  void list_touching();
  // surface_solids.cpp
  void know(const Drive& around, double time);
  StepStatus pressed_solids(const StepView& step, const SurfaceStage& stage) const;
  void resize(std::size_t planes);
  void find_tangents(const Drive& around, double t0, double t1, const Points& x0, double way, bool own = true);
  void turn_tangents(const StepView& step, const Points& x1);
  // surface_jumps.cpp
  bool gaps_at(const Drive& around, double time, const Points& x, double way, double& deepest);
  void shift(Points& x) const;
  const std::vector<int>& near(int q, const Points& x);

  const Samples& samples_;
  double length_;
  SampleSearch search_;
  Tangents tangents_;
  bool solids_ = false;        ///< any obstacle is met as a solid
  int flat_ = 0;               ///< number of half-spaces, which come first; then one plane for each supporting half-space of a solid
  std::vector<int> obstacle_;  ///< obstacle of each plane
  std::vector<int> alone_;     ///< the one sample of a supporting half-space; -1: the plane is for all samples
  std::vector<Vec3> own_;      ///< place of the solid's own sample at each plane [m]
  SurfaceStage drift_, close_;
  FreeRows free_rows_;
  std::vector<FreeState> free_start_;            ///< free bodies at the start of the step
  std::vector<HalfSpace> start_, middle_, end_;  ///< the planes at the start of the step, in its middle, at its end
  std::vector<double> friction_;
  std::vector<char> still_;
  std::vector<SolidPose> poses_;  ///< of the planes at the end of the step; empty: no half-space stands for a solid
  std::vector<Vec3> normals_;
  std::vector<GapFunction> free_;    ///< gaps before the drift's stage
  std::vector<Candidate> touching_;  ///< samples that touch after the last drift; if known_ >= 0, only those active before it
  int known_ = -1;                   ///< plane whose long list has no further sample that matters; -1: none
  std::vector<Candidate>
      lasting_;         ///< between drift and closing: those of touching_ that touched before the drift; only if first kicks are held
  bool holds_ = false;  ///< first kicks are held
  double slack_ = 0;    ///< tolerance of the last closing [m/s]
  SampleRows at_hand_;  ///< rows that may all stick, and of these rows:
  std::vector<Vec3> begin_, away_;     ///< places at t0, or velocities; distance from where they should be
  std::vector<double> gaps_, bounds_;  ///< gaps after a stage, and what these gaps should be
  std::vector<Vec3> places_;           ///< of the rows of a stage at t1
  bool places_known_ = false;          ///< places_ are those of the drift's rows
  Scalars weights_;                    ///< of one sample
  Points given_;                       ///< impulses of obstacles on the control points [N s]
  Points start_v_, start_force_;       ///< velocities and forces at the start of a step with contact
  PinImpulses pins_;                   ///< impulses of obstacles on pinned points
  bool near_ = false;                  ///< a control point is behind a plane, or a sample was on one
  std::vector<unsigned char> behind_;  ///< bits of the control points behind a plane
  Points room_;                        ///< for the hull of the surface
  bool arrives_ = false;               ///< a sample with friction arrives on its plane in this step
  bool lands_ = false;                 ///< any sample arrives on its plane in this step
  Count version_ = -1, call_ = -1;
  double h_ = -1;
  Count impacts_ = 0;
  double found_ = 0;  ///< operations spent on finding samples and supporting half-spaces
  double most_ = std::numeric_limits<double>::infinity();
  double in_evaluation_ = 1;  ///< operations in an evaluation of the spring forces
};

}  // namespace softffd
