/// Properties of the methods, one row per method.
#pragma once
#include "body/body.hpp"
#include "model/drive.hpp"
#include "model/run.hpp"

namespace softffd {

/// How the turning of the body limits the steps of an implicit method (kit/limits.hpp).
enum class Turning { free, straight, in_frame };

struct Traits {
  Method method;
  int order;
  double work;              ///< work of a step, in evaluations of the spring forces; 0: depends on the lattice (ImplicitWork)
  double given, automatic;  ///< largest step that a user may give, and that is chosen, in units of 2 / omega
  double long_run;          ///< factor of the chosen step in long runs (kit/limits.cpp)
  double damping;           ///< largest step in units of the shortest mass / damping
  double tolerance_sum;     ///< multiple of the tolerance by which all steps of a run together may err; 0: fixed steps
  double tolerance_step;    ///< multiple of the tolerance by which one step may err
  bool resolves_contact;    ///< handles obstacles
  bool solves;              ///< solves with a matrix, under error control
  Turning turning = Turning::free;
  bool passes_over_vibrations = false;  ///< damps vibrations that its steps do not resolve
  bool staggered = false;               ///< velocities belong to half steps before and after: the energy to be compared depends on the step

  bool error_control() const { return tolerance_sum > 0; }
};

const Traits& traits(Method method);

/// Longest step of leapfrog that carries velocities on for the dashpots instead of solving for them [s], and whether a step of length h
/// does so (methods/leapfrog.hpp).
double longest_carried(const Drive& around, const Run& run);
bool carries_velocities(const Drive& around, const Run& run, double h);
/// Returns the work of an explicit step of length h of this body, in evaluations of the spring forces.
double step_work(const Body& body, const Drive& around, const Run& run, Method method, double h);

inline bool resolves_contact(Method method) { return traits(method).resolves_contact; }
inline bool is_implicit(Method method) { return traits(method).solves; }
inline bool passes_over_vibrations(Method method) { return traits(method).passes_over_vibrations; }
/// True if the method may be requested where obstacles meet samples of the surface: leapfrog and backward Euler take over from others.
inline bool meets_surface(Method method) { return method != Method::central_difference; }
/// True if the method may be requested beside free bodies: these methods push the bodies back.
inline bool takes_free_bodies(Method method) {
  return method == Method::automatic || method == Method::leapfrog || method == Method::sdirk2;
}
/// True if the method may be requested for a solid: the central difference is as published, and the widest lattices have no matrices.
bool takes_solid(Method method, const Lattice& lattice);

/// Work in evaluations of the spring forces: of an implicit step without contact, of a factor, of a solution of the linear equations with
/// contact, and of taking a step into the body's frame. It follows from the number of operations and their measured time.
struct ImplicitWork {
  double step, factor, solution, frame = 10;
  explicit ImplicitWork(const Lattice& lattice);
  /// Work of a matrix and of the solutions with it that contact takes, by experience.
  double in_contact() const { return factor + 10 * solution; }
};

}  // namespace softffd
