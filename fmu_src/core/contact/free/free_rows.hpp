/// Effect of contact constraints (rows) on free bodies: on obstacles that they push, and on parts whose pins hold points of the samples.
///
/// A force f on the object in row b gives free body k the force s_b f and the torque r_b x f about the centre of k; the twist of the body
/// moves the row by s_b move + turn x r_b,
///
///      an obstacle:   s = -1,                     r = -(Q_s(x) - X)
///      a pin's part:  s = sum of W_si,            r = sum of W_si (x_i - X),       over the points that the pin holds,
///      a solid's own sample (solid_samples.hpp):  s = 1,   r = its place - X,      if that solid is free,
///
/// so that a force f in row b moves row a, in addition to the motion that the masses of the points allow, by C_ab f with
///
///      C_ab = sum over k of s_a s_b / M + [r_a]x' I^-1 [r_b]x.
#pragma once
#include <functional>
#include <vector>

#include "contact/free/solid_samples.hpp"

namespace softffd {

/// Returns the projection onto the plane across a unit normal.
inline Eigen::Matrix3d across(const Vec3& normal) { return Eigen::Matrix3d::Identity() - normal * normal.transpose(); }

/// A contact constraint (row): a sample of the surface, or a solid's own sample, at a plane.
struct SurfaceRow {
  int plane, sample;
  auto operator<=>(const SurfaceRow&) const = default;
};

/// How a row acts on a free body: s (`weight`) and r (`arm`) of the formulas above.
struct Handle {
  int body = -1;
  double weight = 0;
  Vec3 arm = Vec3::Zero();
};
/// The handles of a row: on its obstacle, and on the parts of pins or on the solid of its own sample.
using Handles = std::vector<Handle>;

class FreeRows {
 public:
  explicit FreeRows(const Samples& samples) : samples_(&samples) {}

  /// Sets the free bodies and their states, for rows at x; the bodies yield by `scale` times their inverse masses. pins: includes the
  /// parts of pins, where nothing else lets them move. The arguments are read until the next call.
  void set_bodies(const Drive& around, const std::vector<FreeState>& states, const Points& x, double scale, bool pins);
  /// Sets data of each plane, which are read whenever a row is evaluated. obstacles: the obstacle that a plane belongs to; places: place
  /// of the solid's own sample that meets the plane [m].
  void set_planes(const std::vector<int>& obstacles, const std::vector<Vec3>& places) {
    obstacles_ = &obstacles;
    places_ = &places;
  }
  bool any() const { return !yields_.empty(); }
  bool any_pin() const { return pins_; }

  /// Returns the handles of a row, valid until the next call.
  const Handles& handles(const SurfaceRow& row);
  Eigen::Matrix3d between(const Handles& a, const Handles& b) const;
  /// Returns the compliance of friction on a solid's own sample that yields by the given matrix [m/N]. Without this compliance a rigid
  /// body that sticks at more places than hold it has no unique solution. The body creeps by this fraction of what its weight would move
  /// it in a step.
  static double give(const Eigen::Matrix3d& yields) { return 1e-6 / 3 * yields.trace(); }

  /// Computes the twist of each body by the forces of rows with these handles.
  void find_twists(const std::vector<Handles>& handles, const std::vector<Vec3>& forces);
  void clear_twists();
  void set_given(const std::vector<Wrench>& given);          ///< sets the wrenches on the bodies, and their twists
  void add_force(const SurfaceRow& row, const Vec3& force);  ///< adds the force of one more row
  const std::vector<Twist>& twists() const { return twists_; }
  /// Computes the forces with which rows with these handles stick. away: displacements of the rows from where they stick [m]; the G of
  /// the masses and the yield of the free bodies, a term of rank six for each body, undo all of them. solve: multiplies four columns
  /// (rows, 4), row by row, by G^-1.
  void stick(const std::vector<Handles>& handles, const std::vector<Vec3>& away, const std::function<void(double*)>& solve,
             std::vector<Vec3>& forces) const;
  /// Writes into a motion of the points how far the parts move the points of their pins [m].
  void move_pins(Points& move) const;
  /// Returns how far free obstacles move a row's sample away from its obstacle [m]; a sample of the object itself does not move here.
  Vec3 parting(const SurfaceRow& row) const;
  /// Returns how far a solid's own sample moves [m]; 0 for a sample of the object, and if the solid is not free.
  Vec3 motion_of_solid(const SurfaceRow& row) const;
  /// The wrench of all rows on each body.
  const std::vector<Wrench>& given() const { return given_; }

 private:
  void add(const Handle& handle, const Vec3& force);
  static Handle handle_on(int body, const Handles& of) {
    for (const Handle& each : of)
      if (each.body == body) return each;
    return {.body = body};
  }
  /// Returns the motion of a row by component i of a twist.
  static Vec3 motion(const Handle& of, int i) { return i < 3 ? Vec3(of.weight * Vec3::Unit(i)) : Vec3(Vec3::Unit(i - 3).cross(of.arm)); }

  struct Yield {
    Eigen::Matrix3d mass, inertia;  ///< inverse mass and inertia, scaled
  };
  const Samples* samples_;
  const std::vector<int>* obstacles_ = nullptr;
  const std::vector<Vec3>* places_ = nullptr;
  const Drive* around_ = nullptr;
  const std::vector<FreeState>* states_ = nullptr;
  const Points* x_ = nullptr;
  /// The handles of the row that was last asked for at a plane.
  struct Known {
    int sample = -1;
    Handles handles;
  };
  Handles find_handles(const SurfaceRow& row) const;
  Vec3 place_of(const SurfaceRow& row) const {
    return samples_->of_object(row.sample) ? samples_->at(row.sample, *x_) : (*places_)[row.plane];
  }
  std::vector<Known> known_;
  std::vector<Yield> yields_;
  std::vector<int> body_of_;  ///< (obstacles) index of the free body; -1: not free
  std::vector<Twist> twists_;
  std::vector<Wrench> given_;
  bool pins_ = false;
};

}  // namespace softffd
