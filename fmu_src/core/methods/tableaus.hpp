/// Coefficients of the explicit Runge-Kutta methods with an embedded error, as runge_kutta.hpp takes them.
#pragma once
#include <array>

namespace softffd {

struct Tableau {
  /// What positions and velocities take of the stages' slopes, (stages) each.
  struct Weights {
    const double *positions, *velocities;
  };
  static constexpr int most_stages = 17;

  int stages;
  int controller_exponent;              ///< order of the embedded method + 1
  bool nystroem;                        ///< for x'' = a(t, x): positions take the accelerations, velocities at the stages do not exist
  const double* c;                      ///< times of the stages, (stages)
  const double* a;                      ///< what stage i takes of those before it begins at i (i - 1) / 2
  Weights b;                            ///< the result's
  Weights error;                        ///< less those of the embedded method
  const double* safer_error = nullptr;  ///< of a second embedded method, of lower order; none: nullptr

  const double* row(int stage) const { return a + stage * (stage - 1) / 2; }
};

namespace tableaus {

/// Dormand, El-Mikkawy, Prince 1987, High-order embedded Runge-Kutta-Nystrom formulae, IMA J. Numer. Anal. 7: order 12(10), 17 stages.
extern const Tableau rkn12;
/// Hairer, Norsett, Wanner 1993, Solving Ordinary Differential Equations I, section II.10: DOP853, order 8(5,3), 12 stages.
extern const Tableau dop853;

}  // namespace tableaus

}  // namespace softffd
