/// One stage of a step in contact: what obstacles do to the samples at the end of the drift, or to their velocities after the closing kick.
///
/// y0 is where the body would be without them, y where it is with the forces f_s = l_s n_q + p_s of the active rows,
/// y = y0 + sum_s W_s f_s / m.
///
/// While the active rows are on one plane, or on parallel ones, friction moves none of them nearer to its plane: the normal forces come
/// first (dual_active_set.hpp), then the friction (disk_friction.hpp): measured, 0.65 of the time that all forces together take where most
/// rows slide. Where that brings a sample behind a plane of another direction, all begins anew:
///
/// Rows on planes of different directions need both at once: all forces of the rows that were active come first (coulomb_rows.hpp), from
/// what stuck and what slid; then the normal forces beside their friction, so that no sample is behind a plane, whatever friction has come
/// to. Where that makes other rows active, both again.
///
/// In nearly every step of lasting contact the rows at hand do, and all of them stick. Then G f undoes gaps and slips at once: three right
/// sides for one factor. That is `hold`, to be tried before `solve`; what other samples do then is for the caller to look at.
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

  /// The planes of what follows, and of those of one sample alone which; -1: of any.
  void set_planes(const std::vector<Vec3>& normals, const std::vector<double>& friction, const std::vector<int>& samples);
  /// Inverse masses of the control points (points), 0 of pinned ones.
  void set_masses(const Scalars& inverse) { set_.delassus().set_masses(inverse); }
  void begin() { set_.delassus().begin(); }  ///< a stretch of steps
  void set_free(FreeRows* free) { set_.delassus().set_free(free); }

  Operations& operations() const { return set_.delassus().operations(); }

  /// To be filled before `solve`: gaps of y0 above the planes, which become those of y, and rows that must be kept, sorted.
  std::vector<GapFunction> gaps;
  std::vector<Candidate> candidates;
  /// Rows that were active before, sorted, and where their friction is looked for first, in parts of its limit.
  std::vector<SurfaceRow> rows;
  std::vector<Vec3> share;

  /// Do the rows at hand, all of one plane, push it and stick? away: how far each is from where it is to be at y0, along its normal and,
  /// where there is friction, across. On success gaps of all planes are those of y.
  bool hold(const std::vector<Vec3>& away);
  /// The same beside free bodies, of any planes; without the factor of the rows' normal forces.
  bool hold_free(const std::vector<Vec3>& away);
  /// slip: of a row at y0, beyond where it would be if it stuck. On success rows and share are those that are active now.
  StepStatus solve(double tolerance, const std::function<Vec3(const SurfaceRow&)>& slip);
  const Vec3& force(int t) const { return force_[t]; }  ///< of an active row
  bool added() const { return added_; }                 ///< a row to those that were active before
  double pinned_violation() const { return set_.pinned_violation(); }
  double compliance(int t) const { return set_.delassus()(t, t); }
  const Points& move() const { return move_; }                  ///< y - y0
  PointRange range() const { return set_.delassus().range(); }  ///< of the points that move
  /// Of free bodies, by the forces.
  const FreeRows* free() const { return set_.delassus().free(); }
  /// v += a (y - y0); and x, where there is one, += y - y0.
  void give(double a, Points& v, Points* x = nullptr) const {
    kernels::move_points(int(v.rows()), range(), move_.data(), a, v.data(), x ? x->data() : nullptr);
  }
  /// By how much Coulomb's law has been missed: of the largest force its excess, or of the largest slip what is left of it, if more.
  double missed() const { return missed_; }

 private:
  double limit(std::size_t t) const { return friction_[rows[t].plane] * set_.forces()[t]; }
  bool aligned(int p, int q) const;
  bool parallel() const;
  bool rubs_apart(double tolerance);
  void rub(const std::function<Vec3(const SurfaceRow&)>& slip);
  template <class Block>
  StepStatus balance(double tolerance, const std::function<Vec3(const SurfaceRow&)>& slip);
  template <class Block>
  void state_law(const std::function<Vec3(const SurfaceRow&)>& slip, bool first);
  StepStatus settle(double tolerance);
  void find_forces();
  void find_move();
  void add_motion(const Points& move) { set_.delassus().move_gaps(move, gaps); }

  DualActiveSet set_;
  std::vector<Vec3> normals_;
  std::vector<double> friction_;
  std::vector<GapFunction> begin_;  ///< of y0
  std::vector<Vec3> force_, p_;
  DiskFriction disks_;
  std::vector<double> limits_;
  std::vector<Vec3> slips_;
  std::vector<SurfaceRow> before_;  ///< rows at the beginning
  /// Where masses alone hold the rows, and where free bodies do.
  template <class Block>
  struct Law {
    CoulombRows<Block> rows;
    typename CoulombRows<Block>::Problem problem;
  };
  std::tuple<Law<double>, Law<Eigen::Matrix3d>> laws_;
  Points move_;                  ///< y - y0 by the forces
  std::vector<double> columns_;  ///< (rows, three and one that is not used)
  bool added_ = false;
  double largest_free_ = 0;  ///< gap or slip of the rows at y0
  double missed_ = 0;
};

}  // namespace softffd
