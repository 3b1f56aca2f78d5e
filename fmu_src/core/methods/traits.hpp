/// The methods' own numbers, one row each.
#pragma once
#include "body/body.hpp"
#include "model/drive.hpp"
#include "model/run.hpp"

namespace softffd {

/// What keeps the steps of an implicit method short where the body turns (kit/limits.hpp).
enum class Turning { free, straight, in_frame };

struct Traits {
  Method method;
  int order;
  double work;              ///< of a step, in evaluations of the spring forces; 0: it depends on the lattice (ImplicitWork)
  double given, automatic;  ///< largest step in units of 2 / omega: that a user may give, that is chosen
  double long_run;          ///< factor of the chosen step in long runs (kit/thresholds.hpp)
  double damping;           ///< largest step in units of the shortest mass / damping
  double tolerance_sum;     ///< fraction of the tolerance by which all steps of a run together may err; 0: fixed steps
  double tolerance_step;    ///< of which one step
  bool resolves_contact;    ///< it knows obstacles
  bool solves;              ///< it solves with a matrix under error control
  Turning turning = Turning::free;
  bool passes_over_vibrations = false;  ///< it damps those that its steps do not resolve
  bool staggered = false;               ///< velocities are those half a step before and after: what counts as energy depends on the step

  bool error_control() const { return tolerance_sum > 0; }
};

const Traits& traits(Method method);

/// The longest step of leapfrog that carries velocities on for the dashpots, rather than solve for them, and whether one of length h does
/// [s] (methods/leapfrog.hpp).
double longest_carried(const Drive& around, const Run& run);
bool carries_velocities(const Drive& around, const Run& run, double h);
/// Work of an explicit step of length h of this body, in evaluations of the spring forces.
double step_work(const Body& body, const Drive& around, const Run& run, Method method, double h);

inline bool resolves_contact(Method method) { return traits(method).resolves_contact; }
inline bool is_implicit(Method method) { return traits(method).solves; }
inline bool passes_over_vibrations(Method method) { return traits(method).passes_over_vibrations; }
/// May it be asked for where obstacles meet samples of the surface? Leapfrog and backward Euler know them, and take over from others.
inline bool meets_surface(Method method) { return method != Method::central_difference; }
/// May it be asked for beside free bodies? These phases push them back.
inline bool takes_free_bodies(Method method) {
  return method == Method::automatic || method == Method::leapfrog || method == Method::sdirk2;
}
/// Whether a solid may be asked for beside it: the central difference is as published, and matrices are not for the widest lattices.
bool takes_solid(Method method, const Lattice& lattice);

/// Work of an implicit step without contact: of a step, of a factor and of taking a step into the body's frame; and of a solution of the
/// linear equations with contact; by the operations they take and their measured time.
struct ImplicitWork {
  double step, factor, solution, frame = 10;
  explicit ImplicitWork(const Lattice& lattice);
  /// Of a matrix and the solutions with it that contact takes, by experience.
  double in_contact() const { return factor + 10 * solution; }
};

}  // namespace softffd
