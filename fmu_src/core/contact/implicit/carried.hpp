/// Rigid motion X(t) that prescribed pins carry a body with, for the two stages of SDIRK2.
///
/// A stage of backward Euler gives a body the velocity of its chord. Where stiff springs tie the body to a pin that turns, the chord of the
/// first stage is the motion at the middle of the stage, so that velocities, torques and the rates of dashpots would be of first order. The
/// stages therefore integrate positions relative to X,
///
///      x1 - X(t + g h) = x0 - X(t) + g h (v1 - X'(t + g h)),
///      x  - X(t + h)   = x0 - X(t) + (1 - g) h (v1 - X'(t + g h)) + g h (v - X'(t + h)),
///
/// which keeps the order of the method for every smooth X and is exact for a body that moves as X does. Several pins carry a point by the
/// mean of their motions, weighted by their numbers of points; a pinned point moves with its own pin.
#pragma once
#include "model/drive.hpp"

namespace softffd {

class Carried {
 public:
  /// t: start of the step [s]. x: points there (points, 3) [m], which must outlive this.
  Carried(const Drive& around, double t, const Points& x);
  /// True if a pin turns or accelerates. Otherwise velocities give the whole motion, and the functions below change nothing.
  bool bends() const { return bends_; }
  /// Moves the points that a stage of h [s] starts from, where the velocities of a stage before it count for `rest` [s]. Pinned points
  /// start so that they come to their places with the velocities of their pins.
  void place(double rest, double h, Points& start) const;
  /// Returns velocities v at time `from` with the change of the carried motion's velocity up to time `to`, valid until the next call.
  const Points& ahead(const Points& v, double from, double to);

 private:
  /// Affine function of the points at the start: 3 x 4, which multiplies (x, 1).
  using Field = Eigen::Matrix<double, 3, 4>;

  template <class Of>
  Field mean(Of of) const;
  Field way(double time) const;
  Field velocity(double time) const;
  void add(const Field& field, Points& y) const;

  const Drive& around_;
  double t_;
  const Points& x_;
  bool bends_;
  Points ahead_;
};

}  // namespace softffd
