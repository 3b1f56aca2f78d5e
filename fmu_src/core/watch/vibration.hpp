/// How far the springs' own motion moves control points. By experience this bounds what an error in the phase of vibrations can amount to,
/// however long that error has been adding up.
#pragma once
#include "body/equations.hpp"
#include "body/model.hpp"
#include "model/state.hpp"

namespace softffd {

/// Returns twice the largest of: the extension of a spring, the displacement by its rate of extension in 2.5 time scales, and the
/// displacements by the present accelerations, including those from which a turning body is held back only by its springs [m]; infinite
/// unless all is finite. time_scale: (3 * points) [s].
double vibration(const Equations& equations, const State& state, const Scalars& time_scale);
/// Returns the same for the present motion of control points whose time scale is below `slowest` [s]: without the extensions, which may be
/// at rest, and without the acceleration that a free body has as a whole [m].
double present_vibration(const Equations& equations, const State& state, const Scalars& time_scale, double slowest);
/// Returns `vibration` for the forces at both ends of what is left [s] of a communication step, the larger of the two. state.time is
/// restored.
double coming_vibration(const Equations& equations, State& state, const Scalars& time_scale, double left);
/// Returns how large the vibrations are at most that a change of the outside forces sets off, from `before` [N] to those until the end of a
/// communication step of H [s], measured as `vibration` measures them [m].
double may_set_off(const Model& model, const Drive& drive, const Points& before, double H);

/// Returns the size of vibrations of this energy [J] with time scales up to `slowest` [s], spread over the body [m].
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
/// Returns the vibration that a change of the outside sets off at the start of a sub-interval, seen from steps that damp it away. It comes
/// from the deforming part of a jump of the forces [N], or of the change of velocity until the end, `kink` of which came at once;
/// whichever moves points more. By experience within a factor of 2, and of 10 where forces jump. jump, u: (points, 3), scratch afterwards.
Vibration set_off(const Equations& equations, const State& start, const State& end, double kink, Points& jump, Points& u);

}  // namespace softffd
