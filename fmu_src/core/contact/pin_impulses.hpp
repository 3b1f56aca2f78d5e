/// What pins give the points that they hold, in an explicit step: reactions and work.
///
/// A pin that is led works along the mean of its point's velocities before and after each half kick. A free pin works along the mean of
/// those before and after the whole step, because kinetic energies change so, of its points and of its part, which gives them what they
/// get. By half kicks, whose forces stand half a step apart, the two would differ by the order of the step.
#pragma once
#include "contact/contact.hpp"

namespace softffd {

/// Calls visit(point) for what free pins hold.
template <class Visit>
void visit_free(const Drive& around, const Visit& visit) {
  for (const Pin& pin : around.pins)
    for (std::size_t n = 0; pin.own && n < pin.points.size(); ++n) visit(pin.points[n]);
}

class PinImpulses {
 public:
  /// A step begins with velocities v.
  void begin(const Drive& around, const Points& v) {
    visit_free(around, [&](int p) {
      for (Points* each : {&start_, &given_}) each->resize(v.rows(), 3);
      set_row(start_, p, row(v, p));
      set_row(given_, p, Vec3::Zero());
    });
  }
  /// A pin gives a point that it holds an impulse [N s]. Returns the work of a pin that is led, whose point has this mean velocity [J].
  double give(const StepView& step, const PinnedPoint& held, const Vec3& impulse, const Vec3& velocity, Exchange& exchange) {
    exchange.pins[held.pin].add(-impulse, held.arm);
    if (step.around.pins[held.pin].own) {
      given_.row(held.point) += impulse.transpose().array();
      return 0;
    }
    const double work = impulse.dot(velocity);
    exchange.work += work;
    return work;
  }
  /// Books the work of free pins in the step, at whose end velocities are v, and returns it [J].
  double book(const Drive& around, const Points& v, Exchange& exchange) const {
    double work = 0;
    visit_free(around, [&](int p) { work += 0.5 * row(given_, p).dot(row(start_, p) + row(v, p)); });
    exchange.work += work;
    return work;
  }

 private:
  Points start_, given_;  ///< of points of free pins: velocities at the start of the step, what they were given in it [N s]
};

/// Pinned points at the end of the drift are where the frame is. start: velocities at the start of the step; impulse(p, v): what brings
/// point p to velocity v beyond the forces on it [N s].
template <class Given>
void drift_pins(const StepView& step, const Points& start, const Given& impulse, Points& v, Points& x1, PinImpulses& given,
                Exchange& exchange) {
  given.begin(step.around, start);
  for (std::size_t a = 0; a < step.around.pins.size(); ++a) {
    const Pin& pin = step.around.pins[a];
    const Frame from = pin.at(step.t0), to = pin.at(step.t1);
    for (std::size_t n = 0; n < pin.points.size(); ++n) {
      const int p = pin.points[n];
      const Vec3 here = to.origin + to.arm(pin.local[n]), velocity = (here - row(step.x0, p)) / step.h;
      given.give(step, {int(a), p, from, from.arm(pin.local[n])}, impulse(p, velocity), 0.5 * (row(start, p) + velocity), exchange);
      set_row(x1, p, here);
      set_row(v, p, velocity);
    }
  }
}

/// Pinned points after the closing half kick have the frame's velocity. middle: velocities before that kick.
template <class Given>
void close_pins(const StepView& step, const Points& middle, const Given& impulse, Points& v, PinImpulses& given, Exchange& exchange) {
  step.around.visit_pinned(step.t1, [&](const PinnedPoint& held) {
    const Vec3 velocity = held.velocity();
    given.give(step, held, impulse(held.point, velocity), 0.5 * (row(middle, held.point) + velocity), exchange);
    set_row(v, held.point, velocity);
  });
}

}  // namespace softffd
