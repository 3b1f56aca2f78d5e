/// What the time integrators share: the state they advance and the span of time they are given.
#pragma once
#include <limits>
#include <vector>

#include "model/free_body.hpp"
#include "model/visit.hpp"

namespace softffd {

/// Friction by which each obstacle holds each point: (planes) (points, 3) [N].
using Holds = std::vector<Points>;

/// Forces by which obstacles hold samples of the surface: rows by number, plane after plane, -1 behind the last. Empty where control points
/// touch.
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

/// Everything that a communication step changes, apart from what it gave back (Exchange).
struct State {
  double time = 0;              ///< [s]
  Points x, v;                  ///< positions [m] and velocities [m/s] at `time`, (points, 3)
  Points spring;                ///< spring forces at x [N]
  MarkedPoints previous;        ///< positions one internal step back; central difference only
  double previous_h = 0;        ///< the step that `previous` belongs to; 0: none
  Holds holds;                  ///< at the end of the last implicit step: what sticks by them need not move first; empty: none yet
  HeldRows held_rows;           ///< the same of samples of the surface, where the next implicit step begins to look
  std::vector<FreeState> free;  ///< bodies, obstacles first

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.time, s.x, s.v, s.spring, s.previous, s.previous_h, s.holds, s.held_rows, s.free);
  }
};
static_assert(visits_every_field<State>);

/// `steps` internal steps of size h; number i of them starts at origin + (first + i) h. Times are counted, not summed: cutting a stretch
/// of time in two gives the same bits.
struct Span {
  double origin;
  Count first;
  double h;
  Count steps;
  double most_work = std::numeric_limits<double>::infinity();  ///< after which a step that iterates gives up; in evaluations of the forces
  double budget = std::numeric_limits<double>::infinity();     ///< of the call, after which it does too
  double way = 0;                                              ///< by which a solution of its equations may be off [m]
  bool again = false;  ///< the method took the step before this one, as long, of the same body: what it made of that may serve
  double time(Count i) const { return origin + double(first + i) * h; }
};

/// Internal steps counted from an origin while their size stays the same.
struct Clock {
  double origin = 0, h = 0;
  Count count = 0;
  double unit = 0;  ///< the given step that h divides; 0: none was given
  Count parts = 1;  ///< internal steps per unit
  double time() const { return origin + double(count) * h; }

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.origin, s.h, s.count, s.unit, s.parts);
  }
};
static_assert(visits_every_field<Clock>);

/// What a frozen factor was made from: enough to make the same bits again.
struct Factored {
  MarkedPoints x;         ///< configuration that the stiffness matrix belongs to [m]
  double h = 0;           ///< step that the factor belongs to [s]; 0: there is none
  Count uses = 0;         ///< steps tried with it
  bool in_frame = false;  ///< x is in the body's frame (floating_frame.hpp)

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.x, s.h, s.uses, s.in_frame);
  }
};
static_assert(visits_every_field<Factored>);

}  // namespace softffd
