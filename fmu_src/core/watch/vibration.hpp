/// How far the springs' own motion moves control points: a bound, by experience, of what an error in the phase of vibrations can amount to,
/// however long it has been adding up.
#pragma once
#include "body/equations.hpp"
#include "body/model.hpp"
#include "model/state.hpp"

namespace softffd {

/// Twice the largest of: extension of a spring, what its rate of extension carries in 2.5 time scales, and what the present accelerations
/// do, those from which a turning body is held back only by its springs among them [m]; infinite unless all is finite. time_scale: (3 *
/// points) [s].
double vibration(const Equations& equations, const State& state, const Scalars& time_scale);
/// What is moving now, of control points whose time scale is below `slowest` [s]: the same without the extensions, which may be at rest,
/// and without the acceleration that a free body has as a whole.
double present_vibration(const Equations& equations, const State& state, const Scalars& time_scale, double slowest);

/// Size of vibrations of this energy [J], of a time scale up to `slowest` [s], spread over the body [m].
double amplitude(const Model& model, double energy, double slowest);

struct Vibration {
  double amplitude = 0;  ///< [m]
  double frequency = 0;  ///< [rad/s]

  template <class Self, class Fields>
  static auto visit(Self& s, Fields&& fields) {
    return fields(s.amplitude, s.frequency);
  }
};
static_assert(visits_every_field<Vibration>);
/// The vibration that a change of the outside sets off at the start of a stretch, to be seen from steps that damp it away: what deforms the
/// body of a jump of the forces [N], or of the change of velocity until the end, `kink` of which came at once; whichever moves points
/// further. By experience within a factor of 2, and of 10 where forces jump. jump, u: (points, 3), scratch afterwards.
Vibration set_off(const Equations& equations, const State& start, const State& end, double kink, Points& jump, Points& u);

}  // namespace softffd
