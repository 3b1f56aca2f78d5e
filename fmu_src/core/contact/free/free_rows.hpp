/// What rows of contact do to free bodies: obstacles that they push, and parts that pins hold points of their samples on.
///
/// A force f on the object in row b gives free body k the force s_b f and the torque r_b x f about its centre; the row sees the body's
/// twist as s_b move + turn x r_b,
///
///      an obstacle:   s = -1,                     r = -(Q_s(x) - X)
///      a pin's part:  s = sum of W_si,            r = sum of W_si (x_i - X),       over the points that the pin holds,
///      a solid's own sample (solid_samples.hpp):  s = 1,   r = its place - X,      if that solid is free,
///
/// so that rows a and b move each other, beside what the masses of the points let them, by C_ab f with
///
///      C_ab = sum over k of s_a s_b / M + [r_a]x' I^-1 [r_b]x.
#pragma once
#include <functional>
#include <vector>

#include "contact/free/solid_samples.hpp"

namespace softffd {

/// What is across a unit normal.
inline Eigen::Matrix3d across(const Vec3& normal) { return Eigen::Matrix3d::Identity() - normal * normal.transpose(); }

/// A row: a sample of the surface, or of a solid's own, at a plane.
struct SurfaceRow {
  int plane, sample;
  auto operator<=>(const SurfaceRow&) const = default;
};

/// How a row acts on a free body.
struct Handle {
  int body = -1;
  double share = 0;
  Vec3 arm = Vec3::Zero();
};
/// On its obstacle, and on the parts of the pins.
using Handles = std::vector<Handle>;

class FreeRows {
 public:
  explicit FreeRows(const Samples& samples) : samples_(&samples) {}

  /// The bodies in these states, rows being at x; what they yield is `scale` times their inverse masses. pins: their parts too, where
  /// nothing else lets them move. Read until the next call.
  void set_bodies(const Drive& around, const std::vector<FreeState>& states, const Points& x, double scale, bool pins);
  /// Of each plane, read whenever a row is looked at: obstacles: whose it is; places: of a solid's own sample that meets it [m].
  void set_planes(const std::vector<int>& obstacles, const std::vector<Vec3>& places) {
    obstacles_ = &obstacles;
    places_ = &places;
  }
  bool any() const { return !yields_.empty(); }
  bool any_pin() const { return pins_; }

  /// Until the next call.
  const Handles& handles(const SurfaceRow& row);
  Eigen::Matrix3d between(const Handles& a, const Handles& b) const;
  /// By which friction on a solid's own sample gives way, of what the sample yields by that matrix [m/N]: a rigid body that sticks at more
  /// places than hold it would have no one solution. It creeps by this share of what its weight would move it by in a step.
  static double give(const Eigen::Matrix3d& yields) { return 1e-6 / 3 * yields.trace(); }

  /// Of each body, by forces f of rows with these handles.
  void find_twists(const std::vector<Handles>& handles, const std::vector<Vec3>& forces);
  void clear_twists();
  void set_given(const std::vector<Wrench>& given);          ///< and the twists by it
  void add_force(const SurfaceRow& row, const Vec3& force);  ///< the same of one more row
  const std::vector<Twist>& twists() const { return twists_; }
  /// Forces by which rows with these handles stick that are away from where they would [m]: the masses' G and what free bodies yield undo
  /// all of it, a term of rank six for each body. solve: G^-1 of four columns (rows, 4) row by row.
  void stick(const std::vector<Handles>& handles, const std::vector<Vec3>& away, const std::function<void(double*)>& solve,
             std::vector<Vec3>& forces) const;
  /// Adds to a motion of the points what the parts take the points of their pins by.
  void move_pins(Points& move) const;
  /// By which free obstacles move a row's sample away from its obstacle, the object's not being moved [m].
  Vec3 parting(const SurfaceRow& row) const;
  /// By which a solid's own sample moves; 0 of the object's, and where the solid is not free [m].
  Vec3 motion_of_solid(const SurfaceRow& row) const;
  /// What all rows gave each body.
  const std::vector<Wrench>& given() const { return given_; }

 private:
  void add(const Handle& handle, const Vec3& force);
  static Handle handle_on(int body, const Handles& of) {
    for (const Handle& each : of)
      if (each.body == body) return each;
    return {.body = body};
  }
  /// Of a row by unknown i of a twist.
  static Vec3 motion(const Handle& of, int i) { return i < 3 ? Vec3(of.share * Vec3::Unit(i)) : Vec3(Vec3::Unit(i - 3).cross(of.arm)); }

  struct Yield {
    Eigen::Matrix3d mass, inertia;  ///< inverse ones, scaled
  };
  const Samples* samples_;
  const std::vector<int>* obstacles_ = nullptr;
  const std::vector<Vec3>* places_ = nullptr;
  const Drive* around_ = nullptr;
  const std::vector<FreeState>* states_ = nullptr;
  const Points* x_ = nullptr;
  /// Of a row that was asked for, by its plane.
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
  std::vector<int> body_of_;  ///< (obstacles) -1: not free
  std::vector<Twist> twists_;
  std::vector<Wrench> given_;
  bool pins_ = false;
};

}  // namespace softffd
