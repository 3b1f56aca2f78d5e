/// Impulses and work of pins on the points that they hold, in an explicit step.
///
/// The work of a pin with prescribed motion uses the mean of the point's velocities before and after each half kick. The work of a free
/// pin uses the mean of the velocities before and after the whole step, because the kinetic energies of the points, and of the part that
/// gives them the impulses, change so. With half kicks, whose forces are half a step apart, the two would differ by the order of the
/// step.
#pragma once
#include "contact/contact.hpp"

namespace softffd {

/// Calls visit(point) for each point that a free pin holds.
template <class Visit>
void visit_free(const Drive& around, const Visit& visit) {
  for (const Pin& pin : around.pins)
    for (std::size_t n = 0; pin.own && n < pin.points.size(); ++n) visit(pin.points[n]);
}

class PinImpulses {
 public:
  /// Begins a step with velocities v.
  void begin(const Drive& around, const Points& v) {
    visit_free(around, [&](int p) {
      for (Points* each : {&start_, &given_}) each->resize(v.rows(), 3);
      set_row(start_, p, row(v, p));
      set_row(given_, p, Vec3::Zero());
    });
  }
  /// Books an impulse [N s] of a pin on a point that it holds. velocity: mean velocity of the point. Returns the work of a pin with
  /// prescribed motion, 0 for a free pin [J].
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
  /// Books and returns the work of free pins in the step [J]. v: velocities at the end of the step.
  double book(const Drive& around, const Points& v, Exchange& exchange) const {
    double work = 0;
    visit_free(around, [&](int p) { work += 0.5 * row(given_, p).dot(row(start_, p) + row(v, p)); });
    exchange.work += work;
    return work;
  }

 private:
  Points start_, given_;  ///< of points of free pins: velocity at the start of the step [m/s], impulse received in the step [N s]
};

/// Moves pinned points to where their frame is at the end of the drift. start: velocities at the start of the step; impulse(p, v):
/// impulse that brings point p to velocity v, beyond the forces on p [N s].
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

/// Gives pinned points the velocity of their frame after the closing half kick. middle: velocities before that kick.
template <class Given>
void close_pins(const StepView& step, const Points& middle, const Given& impulse, Points& v, PinImpulses& given, Exchange& exchange) {
  step.around.visit_pinned(step.t1, [&](const PinnedPoint& held) {
    const Vec3 velocity = held.velocity();
    given.give(step, held, impulse(held.point, velocity), 0.5 * (row(middle, held.point) + velocity), exchange);
    set_row(v, held.point, velocity);
  });
}

}  // namespace softffd
