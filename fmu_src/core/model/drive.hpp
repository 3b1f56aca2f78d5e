/// What acts on the body from outside during one communication step.
#pragma once
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <vector>

#include "model/pin.hpp"
#include "model/plane.hpp"

namespace softffd {

/// A control point that a pin holds, at one moment.
struct PinnedPoint {
  int pin, point;
  const Frame& frame;
  Vec3 arm;  ///< from the frame's origin to the point [m]
  Vec3 place() const { return frame.origin + arm; }
  Vec3 velocity() const { return frame.material_velocity(arm); }
};

struct Drive {
  std::vector<Plane> planes;
  std::vector<Pin> pins;
  std::vector<FreeMotion> free;      ///< motions of the free bodies, in the order of the state
  Points force;                      ///< gravity, loads and point forces at time `since` (points, 3) [N]
  Points force_rate;                 ///< their time derivative at `since` [N/s]; filled only if `ramped`
  std::array<Points, 2> force_bend;  ///< second and third derivative [N/s2, N/s3]; filled only if `bent`
  bool ramped = false;               ///< some derivative is not zero
  bool bent = false;                 ///< some second or third derivative is not zero
  bool even = false;                 ///< the forces are the same on all points, and not ramped
  double since = 0;                  ///< start of the communication step [s]
  Count call = 0;                    ///< a different number in each communication step
  bool watch = false;                ///< the Exchange is to contain dissipated energy and work
  bool damping_unwatched = false;    ///< but not the energy that damping takes, which costs most to compute

  /// True if a pin holds the body and the frame of the pin is not a free part.
  bool held() const {
    return std::any_of(pins.begin(), pins.end(), [](const Pin& pin) { return !pin.own; });
  }
  /// Returns the change of coordinate i (of 3 * points) of the outside forces from `since` to time t [N].
  double ramp(Eigen::Index i, double t) const {
    const double s = t - since;
    return bent ? s * (force_rate(i) + s * (force_bend[0](i) / 2 + s * force_bend[1](i) / 6)) : s * force_rate(i);
  }
  /// Returns the time derivative of that coordinate [N/s].
  double ramp_rate(Eigen::Index i, double t) const {
    const double s = t - since;
    return bent ? force_rate(i) + s * (force_bend[0](i) + s * force_bend[1](i) / 2) : force_rate(i);
  }
  /// out = outside forces at time t [N].
  void force_at(double t, Points& out) const {
    out = force;
    for (Eigen::Index i = 0; ramped && i < out.size(); ++i) out(i) += ramp(i, t);
  }
  /// Calls visit(PinnedPoint) for the points of all pins at time t.
  template <class Visit>
  void visit_pinned(double t, Visit visit) const {
    for (std::size_t a = 0; a < pins.size(); ++a) {
      const Frame frame = pins[a].at(t);
      for (std::size_t n = 0; n < pins[a].points.size(); ++n)
        visit(PinnedPoint{int(a), pins[a].points[n], frame, frame.arm(pins[a].local[n])});
    }
  }
  /// Returns the sum over all coordinates of `ramp` times x (points, 3); ramp_rate_dot does the same with `ramp_rate`.
  template <class X>
  double ramp_dot(double t, const Eigen::ArrayBase<X>& x) const {
    double sum = 0;
    for (Eigen::Index i = 0; i < x.size(); ++i) sum += ramp(i, t) * x.derived().coeff(i);
    return sum;
  }
  double ramp_rate_dot(double t, const Points& x) const {
    double sum = 0;
    for (Eigen::Index i = 0; i < x.size(); ++i) sum += ramp_rate(i, t) * x(i);
    return sum;
  }
};

}  // namespace softffd
