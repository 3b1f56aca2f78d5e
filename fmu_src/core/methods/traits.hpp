/// The methods' own numbers.
#pragma once
#include <limits>

#include "model/lattice.hpp"
#include "model/method.hpp"

namespace softffd {

struct Traits {
  int order;
  double work;              ///< of a step, in evaluations of the spring forces
  double given, automatic;  ///< largest step in units of 2 / omega: that a user may give, that is chosen
  double summed_share;      ///< share of the tolerance by which all steps of a run together may err; 0: fixed steps
  double largest_share;     ///< of which one step
  bool error_control() const { return summed_share > 0; }
};

/// Share of the tolerance that the summed errors of a fixed-step method may take by forecast.
inline constexpr double forecast_share = 1.5;

/// Linear theory allows leapfrog 1. An automatic step keeps omega h <= 1.36, clear of sqrt(3) and sqrt(2), where an undamped mode comes
/// back in phase with the springs' own nonlinearity every third or fourth step and gains energy without limit. The Runge-Kutta methods'
/// intervals on the imaginary axis are 8.3 (rkn12) and 5.9 (dop853).
inline Traits traits(Method method) {
  constexpr double any = std::numeric_limits<double>::infinity();
  switch (method) {
    case Method::bm4: return {4, 6.6, 1.96, 1.6, 0, 0};
    case Method::rkn12: return {12, 20, 4.1, 3.9, 5, 1};
    case Method::dop853: return {8, 17, 2.9, 2.8, 6, 0.3};
    case Method::ros34pw2:
    case Method::floating_frame: return {3, 0, any, any, 40, 0.3};  // their work depends on the lattice: implicit_work
    case Method::backward_euler: return {1, 150, any, any, 0, 0};
    default: return {2, 1.15, 0.98, 0.68, 0, 0};
  }
}

/// Does the method know obstacles? With a given step `automatic` is leapfrog.
inline bool resolves_contact(Method method) {
  return method == Method::automatic || method == Method::leapfrog || method == Method::central_difference;
}
/// Does the method with error control solve with a matrix?
inline bool is_implicit(Method method) { return method == Method::ros34pw2 || method == Method::floating_frame; }
/// Those that lattices too wide for matrices do not have.
inline bool needs_matrices(Method method) { return is_implicit(method) || method == Method::backward_euler; }

/// Work of an implicit step without contact: of a step, of a factor and of taking a step into the body's frame, by the operations they take
/// and their measured time on 4 x 4 x 4.
struct ImplicitWork {
  double step, factor, frame = 10;
  explicit ImplicitWork(const Lattice& lattice);
};

}  // namespace softffd
