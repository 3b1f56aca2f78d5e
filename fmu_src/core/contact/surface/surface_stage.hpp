/// One stage of a step in contact: obstacles act on the samples at the end of the drift, or on their velocities after the closing kick.
///
/// y0 is the state of the body without obstacles. y is its state with the forces f_s = l_s n_q + p_s of the active rows,
/// y = y0 + sum_s W_s f_s / m.
///
/// While the active rows are on one plane, or on parallel planes, friction moves none of them nearer to its plane. The normal forces are
/// then found first (dual_active_set.hpp) and the friction after them (disk_friction.hpp): measured, this takes 0.65 of the time for all
/// forces together, where most rows slide. If friction brings a sample behind a plane of another direction, the stage begins anew:
///
/// Rows on planes of different directions need both at once. All forces of the rows that were active are found first (coulomb_rows.hpp),
/// starting from what stuck and what slid; then the normal forces beside this friction, so that no sample is behind a plane, whatever the
/// friction has become. If this makes other rows active, both are repeated.
///
/// In nearly every step of lasting contact the current rows suffice and all of them stick. Then G f cancels gaps and slips at once: three
/// right-hand sides for one factor. `warm_start` does that, to be tried before `solve`. The caller has to check what other samples do then.
#pragma once
#include <functional>
#include <tuple>

#include "contact/coulomb_rows.hpp"
#include "contact/surface/disk_friction.hpp"
#include "contact/surface/dual_active_set.hpp"
#include "contact/surface/surface_loops.hpp"

namespace softffd {

class SurfaceStage {
 public:
  explicit SurfaceStage(const Samples& samples) : set_(samples) {}

  /// Sets the planes for what follows. samples: of each plane the one sample that it is for; -1: it is for all samples.
  void set_planes(const std::vector<Vec3>& normals, const std::vector<double>& friction, const std::vector<int>& samples);
  /// Sets the inverse masses of the control points (points), 0 of pinned ones.
  void set_masses(const Scalars& inverse) { set_.delassus().set_masses(inverse); }
  void begin() { set_.delassus().begin(); }  ///< begins a sub-interval
  void set_free(FreeRows* free) { set_.delassus().set_free(free); }

  Operations& operations() const { return set_.delassus().operations(); }

  /// To be filled before `solve`: gaps of y0 above the planes, which become those of y; and contact constraints to be satisfied, sorted.
  std::vector<GapFunction> gaps;
  std::vector<Candidate> candidates;
  /// Rows that were active before, sorted, and the start values of their friction as ratios to its limit.
  std::vector<SurfaceRow> rows;
  std::vector<Vec3> fraction;

  /// True if the current rows, all on one plane, press on it and stick. away: of each row, distance at y0 from where it should be, along
  /// its normal and, if there is friction, across. On success the gaps of all planes are those of y.
  bool warm_start(const std::vector<Vec3>& away);
  /// Does the same beside free bodies, for rows on any planes and without the factor of their normal forces.
  bool warm_start_free(const std::vector<Vec3>& away);
  /// slip: of a row at y0, relative to where it would be if it stuck. On success `rows` and `fraction` are those of the rows active now.
  StepStatus solve(double tolerance, const std::function<Vec3(const SurfaceRow&)>& slip);
  const Vec3& force(int t) const { return force_[t]; }  ///< of an active row
  bool added() const { return added_; }                 ///< a row has become active that was not before
  double pinned_violation() const { return set_.pinned_violation(); }
  double compliance(int t) const { return set_.delassus()(t, t); }
  const Points& move() const { return move_; }                  ///< y - y0
  PointRange range() const { return set_.delassus().range(); }  ///< of the points that move
  /// Free bodies, with their motion due to the forces.
  const FreeRows* free() const { return set_.delassus().free(); }
  /// v += a (y - y0), and x += y - y0 unless x is null.
  void give(double a, Points& v, Points* x = nullptr) const {
    kernels::move_points(int(v.rows()), range(), move_.data(), a, v.data(), x ? x->data() : nullptr);
  }
  /// Returns the error of Coulomb's law: the excess of friction as a fraction of the largest force, or the remaining slip as a fraction
  /// of the largest slip, whichever is more.
  double missed() const { return missed_; }

 private:
  double limit(std::size_t t) const { return friction_[rows[t].plane] * set_.forces()[t]; }
  bool aligned(int p, int q) const;
  bool parallel() const;
  bool stays_apart(double tolerance);
  void solve_friction(const std::function<Vec3(const SurfaceRow&)>& slip);
  template <class Block>
  StepStatus solve_all_forces(double tolerance, const std::function<Vec3(const SurfaceRow&)>& slip);
  template <class Block>
  void state_law(const std::function<Vec3(const SurfaceRow&)>& slip, bool first);
  StepStatus solve_normal_forces(double tolerance);
  void find_forces();
  void find_move();
  void add_motion(const Points& move) { set_.delassus().move_gaps(move, gaps); }

  DualActiveSet set_;
  std::vector<Vec3> normals_;
  std::vector<double> friction_;
  std::vector<GapFunction> begin_;  ///< gaps of y0
  std::vector<Vec3> force_, p_;
  DiskFriction disks_;
  std::vector<double> limits_;
  std::vector<Vec3> slips_;
  std::vector<SurfaceRow> before_;  ///< rows at the beginning of `solve`
  /// Coulomb's law at the rows: with numbers if masses alone resist the forces, with matrices if free bodies do too.
  template <class Block>
  struct Law {
    CoulombRows<Block> rows;
    typename CoulombRows<Block>::Problem problem;
  };
  std::tuple<Law<double>, Law<Eigen::Matrix3d>> laws_;
  Points move_;                  ///< y - y0 due to the forces
  std::vector<double> columns_;  ///< (rows, 4): three right-hand sides and an unused one
  bool added_ = false;
  double largest_free_ = 0;  ///< largest gap or slip of the rows at y0
  double missed_ = 0;
};

}  // namespace softffd
