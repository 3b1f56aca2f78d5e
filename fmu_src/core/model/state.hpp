/// State that the time integrators share and advance, and the span of time that they are given.
#pragma once
#include <limits>
#include <vector>

#include "model/free_body.hpp"
#include "model/visit.hpp"

namespace softffd {

/// Friction force of each obstacle on each control point: (planes) (points, 3) [N].
using Holds = std::vector<Points>;

/// Forces of obstacles on samples of the surface: contact constraints by number, plane after plane, -1 behind the last. Empty if control
/// points meet the obstacles.
struct HeldRows {
  std::vector<Count> rows;
  Points forces;  ///< (rows, 3) [N]

  void forget() {
    std::fill(rows.begin(), rows.end(), -1);
    forces.setZero();
  }

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.rows, s.forces);
  }
};
static_assert(visits_every_field<HeldRows>);

/// Everything that a communication step changes, except the reactions on the outside (Exchange).
struct State {
  double time = 0;              ///< [s]
  Points x, v;                  ///< positions [m] and velocities [m/s] at `time`, (points, 3)
  Points spring;                ///< spring forces at x [N]
  MarkedPoints previous;        ///< positions one internal step back; central difference only
  double previous_h = 0;        ///< the step that `previous` belongs to [s]; 0: there is none
  Holds holds;                  ///< warm start from the last implicit step: what sticks need not move first; empty: none yet
  HeldRows held_rows;           ///< warm start of the next implicit step, for samples of the surface
  std::vector<FreeState> free;  ///< free bodies, obstacles first

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.time, s.x, s.v, s.spring, s.previous, s.previous_h, s.holds, s.held_rows, s.free);
  }
};
static_assert(visits_every_field<State>);

/// `steps` internal steps of size h; step i of them starts at origin + (first + i) h. Times are counted, not summed: splitting a
/// sub-interval in two gives the same bits.
struct Span {
  double origin;
  Count first;
  double h;
  Count steps;
  double most_work = std::numeric_limits<double>::infinity();  ///< work at which an iterating step gives up; in evaluations of the forces
  double budget = std::numeric_limits<double>::infinity();     ///< work left to the call, at which the step gives up too
  double way = 0;                                              ///< allowed error of the solution of a step's equations [m]
  bool again = false;  ///< the method took the previous step too, with equal length and body: its results may serve again
  double time(Count i) const { return origin + double(first + i) * h; }
};

/// Internal steps counted from an origin while their size stays the same.
struct Clock {
  double origin = 0, h = 0;
  Count count = 0;
  double unit = 0;  ///< the given step that h divides [s]; 0: none was given
  Count parts = 1;  ///< internal steps per unit
  double time() const { return origin + double(count) * h; }

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.origin, s.h, s.count, s.unit, s.parts);
  }
};
static_assert(visits_every_field<Clock>);

/// Origin of a frozen factor: the data needed to make the same bits again.
struct Factored {
  MarkedPoints x;         ///< configuration that the stiffness matrix belongs to [m]
  double h = 0;           ///< step that the factor belongs to [s]; 0: there is none
  Count uses = 0;         ///< steps tried with the factor
  bool in_frame = false;  ///< x is in the body's frame (floating_frame.hpp)

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.x, s.h, s.uses, s.in_frame);
  }
};
static_assert(visits_every_field<Factored>);

}  // namespace softffd
