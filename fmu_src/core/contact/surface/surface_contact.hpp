/// Contact of the object's own surface with obstacle planes, explicit: no sample of the surface is behind a plane at the end of any
/// internal step. Control points may be.
///
/// The gap of a sample is linear in the control points, n . Q_s(x) - c with Q_s(x) = sum W_si x_i, so that what the obstacles do is one
/// convex problem of the whole body (surface_stage.hpp), twice a step as with contact of control points (contact.hpp):
///
///      drift   x1 = x0 + h v is moved to the nearest body that no plane cuts, in the metric of the masses; v by the move over h
///      close   velocities after the closing half kick likewise, for the samples that touch a plane at t1
///
/// A sample that arrives at the share th of the step gets (1 - th) of its impulse at the drift and the rest at the closing, which is second
/// order. Friction brakes the slip after the impact alone: at the drift a sample that arrives is to stick where it would be if it had slid
/// freely until then,
///
///      target = Q_s(x0) + h w + th (its free slip),      one that was on the plane at t0: th = 0,
///
/// with the velocity w of the obstacle's material; what sticks stays at its target, so that nothing creeps. Contact adds no kinetic energy
/// on planes at rest; were th to make it, the stage is done again with th = 0.
///
/// The rows that are active, and the friction on them, are where the next step begins to look; they belong to the state (model/run.hpp).
/// While a body rests, rolls or sways on one plane they do for nearly every step (surface_hold.cpp). The closing begins with those of the
/// drift: of crowded samples many would carry the body as well, and friction on others could not hold what those hold.
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

  /// Moves the body out of planes at a communication point; velocities stay. As a whole where nothing is pinned and that does; the rest is
  /// pushed in. Sets `moved` if there was any.
  StepStatus clear_jumps(const Body& body, const Drive& around, double time, Points& x, bool& moved);
  /// The same of free obstacles, out of others.
  StepStatus clear_free_jumps(const Drive& around, double time, std::vector<FreeState>& free, bool& moved) {
    return tangents_.move_out(around, time, free, moved);
  }
  /// Samples on each plane, counted.
  void count(const Drive& around, double time, const Points& x, std::vector<Count>& contacts);

  /// Before steps of size h from t0 on, with these half kicks.
  void begin(const Body& body, const HalfKicks& kicks, const Drive& around, double t0, double h);
  /// After `begin`, where the first kick is to be held: finds the samples that touch an obstacle at x.
  void look(const Drive& around, double time, const Points& x);
  /// Looks whether the free drift to x1 may bring the surface to an obstacle. rows: of the state.
  void find(const StepView& step, const Points& x1, const SurfaceRows& rows);
  /// Then, as in contact.hpp.
  /// free: bodies, as they begin the step, that end it as they fly and obstacles, or contact, push them.
  StepStatus drift(const StepView& step, const Points& before, Points& v, Points& x1, SurfaceRows& rows, std::vector<FreeState>& free,
                   Exchange& exchange);
  StepStatus close(const StepView& step, Points& v, SurfaceRows& rows, std::vector<FreeState>& free, Exchange& exchange);
  /// Energy that contact took in the step that `close` has ended, less the work of the obstacles' own motion [J], where kicks are those of
  /// kick.hpp. v1: velocities at its end.
  double loss(const StepView& step, const Points& v1) const;
  /// The part of it that points of free pins had.
  double loss_of_free_pins(const StepView& step, const Points& v1) const;
  /// Where it is not asked for, nothing is kept for it.
  static bool wants_loss(const StepView& step) { return step.around.watch || !step.body.damped; }
  /// Is anything there for `hold`? Where not, it would leave all velocities as they are.
  bool lasts(const SurfaceRows& rows) const { return !lasting_.empty() || (!rows.close.empty() && rows.close[0] >= 0); }
  /// Velocities with the samples held that touch at this end of the step, before its drift, and did at the other end, after it; nothing
  /// else changes.
  StepStatus hold(const StepView& step, Points& v, const SurfaceRows& rows, const std::vector<FreeState>& free) {
    set_free(step.around, free, step.x0);
    return stop(lasting_, step, v, rows);
  }

  /// Was anything near that was found?
  bool near() const { return near_; }
  /// Does any sample touch a plane after the last drift?
  bool touched() const { return !touching_.empty(); }
  Count impacts() const { return impacts_; }

  /// Work that may be done from here on, in evaluations of the spring forces; beyond it a step is given up. And what has been done.
  void allow(double most);
  double work() const;
  bool spent() const { return !(work() <= most_); }

 private:
  using Slip = std::function<Vec3(const SurfaceRow&)>;
  /// By which the state knows a row.
  /// In the order of the rows: solids' own samples come last.
  Count number(const SurfaceRow& row) const {
    return Count(obstacle_[row.plane] + (samples_.of_object(row.sample) ? 0 : still_.size())) * samples_.all() + row.sample;
  }
  /// Its plane as an obstacle; that of a solid's own sample is none.
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
  bool find_heights(const Points& x1);
  void search(int q, const Scalars& gaps, double way);
  double slack_of_rows() const;
  StepStatus fit(const std::vector<Count>& rows, const Points& friction, double way, const Slip& slip);
  bool sticks() const;
  StepStatus stop(const std::vector<Candidate>& candidates, const StepView& step, Points& v, const SurfaceRows& rows);
  StepStatus find_stop(const std::vector<Candidate>& candidates, const StepView& step, const Points& v, const SurfaceRows& rows);
  void share_work(SurfaceStage& stage);
  StepStatus position_stage(const StepView& step, const Points& v, const Points& x1, const SurfaceRows& rows);
  StepStatus meet_near(const StepView& step, const Points& v, const Points& x1, const SurfaceRows& rows);
  Vec3 aim(const StepView& step, const Vec3& free, const SurfaceRow& row, bool at_once);
  bool gains(const StepView& step, const Points& x1) const;
  void find_places(const SurfaceStage& stage, const Points& x1);
  /// Is it a row of a solid's own sample?
  bool own(const SurfaceRow& row) const { return !samples_.of_object(row.sample); }
  const Tangent& tangent_of(const SurfaceRow& row) const { return tangents_.found()[row.plane - flat_]; }
  /// Of the sample of a row: at the end of the step that x belongs to, or at its end without contact.
  Vec3 begin_of(const SurfaceRow& row, const Points& x0) const { return own(row) ? tangent_of(row).place : samples_.at(row.sample, x0); }
  Vec3 flown_of(const SurfaceRow& row, const Points& x1) const { return own(row) ? tangent_of(row).flown : samples_.at(row.sample, x1); }
  Vec3 velocity_of(const SurfaceRow& row, const Points& v) const {
    return own(row) ? tangent_of(row).velocity : samples_.at(row.sample, v);
  }
  void find_speeds(const Points& v, int but = -1);
  double book(const StepView& step, const SurfaceStage& stage, double per_force, Exchange& exchange);
  double give_pins(const StepView& step, const SurfaceStage& stage, double per_force, Exchange& exchange);
  // surface_hold.cpp
  bool recall(const std::vector<Count>& numbers, SurfaceStage& stage) const;
  bool hold_drift(const StepView& step, const Points& v, const Points& x1, const SurfaceRows& rows);
  bool hold_free_drift(const StepView& step, const Points& x1, const SurfaceRows& rows);
  bool hold_free_close(const StepView& step, const Points& v);
  bool list_held(double h, const Points& v);
  bool hold_close(const StepView& step, const Points& v, const std::vector<Candidate>& candidates);
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
  bool solids_ = false;        ///< any obstacle is one
  int flat_ = 0;               ///< number of half-spaces, which come first; then planes of the tangents, one each
  std::vector<int> obstacle_;  ///< whose plane it is
  std::vector<int> alone_;     ///< of a tangent its sample; -1
  std::vector<Vec3> own_;      ///< place of a solid's own sample
  SurfaceStage drift_, close_;
  FreeRows free_rows_;
  std::vector<FreeState> free_start_;            ///< at the start of the step
  std::vector<HalfSpace> start_, middle_, end_;  ///< the planes at the start of the step, in its middle, at its end
  std::vector<double> friction_;
  std::vector<char> still_;
  std::vector<SolidPose> poses_;  ///< at the end of the step; none: no half-space stands for a solid
  std::vector<Vec3> normals_;
  std::vector<GapFunction> free_;    ///< gaps before a stage
  std::vector<Candidate> touching_;  ///< after the last drift; or of these those that were active before it,
  int known_ = -1;                   ///< where a long list of this plane alone has no other that matters
  std::vector<Candidate>
      lasting_;         ///< of these, between drift and closing, those that touched before the drift; where first kicks are held
  bool holds_ = false;  ///< they are
  double slack_ = 0;    ///< of the last closing [m/s]
  SampleRows at_hand_;  ///< the rows that may hold, and of these:
  std::vector<Vec3> begin_, away_;     ///< where they are at t0, or how fast they move; how far from where they are to be
  std::vector<double> gaps_, bounds_;  ///< gaps after a stage, and what they are to be
  std::vector<Vec3> places_;           ///< of the rows of a stage at t1
  bool places_known_ = false;          ///< they are those of the drift's rows
  Scalars weights_;                    ///< of a sample
  Points given_;                       ///< by obstacles to the control points [N s]
  Points start_v_, start_force_;       ///< at the start of a step with contact
  PinImpulses pins_;                   ///< of what obstacles give pinned points
  bool near_ = false;                  ///< a control point is behind a plane, or a sample was on one
  std::vector<unsigned char> behind_;  ///< which
  Points room_;                        ///< of the surface's hull
  bool arrives_ = false;               ///< a sample with friction comes onto its plane in this step
  bool lands_ = false;                 ///< any sample does
  Count version_ = -1, call_ = -1;
  double h_ = -1;
  Count impacts_ = 0;
  double found_ = 0;  ///< operations to find samples and tangents
  double most_ = std::numeric_limits<double>::infinity();
  double in_evaluation_ = 1;  ///< operations
};

}  // namespace softffd
