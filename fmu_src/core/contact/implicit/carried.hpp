/// Motion A(t) of the space around a body that its support gives it, for the two stages of SDIRK2: that of prescribed pins which turn or
/// accelerate, or of the one obstacle that the body touches, with a flat face.
///
/// A stage of backward Euler gives a body the velocity of its chord. What stiff springs tie to a pin that turns, or what a turning plane
/// keeps in front of it, would get the velocity at the middle of the first stage: velocities, torques and the rates of dashpots would be of
/// first order. The stages therefore integrate positions y that A carries, x = A(t) y with A = 1 at the start. With W = A' A^-1, the
/// velocity of the carried space, and L the linear part of A:
///
///      y' = L^-1 (v - W(x)),
///      x1 = A(t + g h) y0 + g h (v1 - W(x1)),                          at the end of the first stage,
///      x  = A(t + h) (y0 + (1 - g) h y1') + g h (v - W(x))             at the end of the step.
///
/// W is evaluated at the place that y' of the stage before leads to, which is off by the second order. The order of the method stays the
/// same for every smooth A. What moves with A, or along a face that A carries, has its velocity to rounding. Several pins carry a point by
/// the mean of their motions, weighted by their numbers of points; a pinned point moves with its own pin.
#pragma once
#include <optional>

#include "body/samples.hpp"
#include "model/drive.hpp"

namespace softffd {

class Carried {
 public:
  /// t: start of the step [s]. x: points there (points, 3) [m], which must outlive this. samples: points of the surface that obstacles
  /// meet; null: they meet the points. length: largest side of the box [m].
  Carried(const Drive& around, double t, const Points& x, const Samples* samples, double length);
  /// False if velocities give the whole motion of the support, so that the stages are the usual ones.
  bool bends() const { return by_pins_ || face_; }
  /// Sets y' from velocities v at `time`, the start of the step or the end of its first stage [s], where the points are at x.
  void rates(double time, const Points& x, const Points& v);
  /// Opens a stage of h [s] that ends at `time` and has spent `rest` [s] at y'. Sets `start` so that start + h v is the end of the stage,
  /// and returns approximate velocities v there, valid until the next call.
  const Points& open(double time, double rest, double h, Points& start);

 private:
  /// Affine function of places: 3 x 4, which multiplies (x, 1).
  using Field = Eigen::Matrix<double, 3, 4>;
  /// A(t) and A'(t).
  struct Motion {
    Field place, velocity;
    Field wind() const;
  };
  Motion at(double time) const;
  Motion of_pins(double time) const;
  Motion of_face(double time) const;

  const Drive& around_;
  double t_;
  const Points& x_;
  bool by_pins_;
  std::optional<Plane> face_;  ///< what the body touches, as a half-space
  Vec3 middle_;                ///< of the points at the start [m]
  Points rate_, ahead_;        ///< y' and approximate velocities [m/s]
};

}  // namespace softffd
