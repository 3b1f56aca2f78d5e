/// Coefficients of the explicit Runge-Kutta methods with an embedded error estimate, for runge_kutta.hpp.
#pragma once
#include <array>

namespace softffd {

struct Tableau {
  /// Weights of the stages' slopes in positions and velocities, (stages) each.
  struct Weights {
    const double *positions, *velocities;
  };
  static constexpr int most_stages = 17;

  int stages;
  int controller_exponent;              ///< order of the embedded method + 1
  bool nystroem;                        ///< for x'' = a(t, x): positions use the accelerations, stages have no velocities
  const double* c;                      ///< times of the stages, (stages)
  const double* a;                      ///< weights of earlier stages; those of stage i begin at i (i - 1) / 2
  Weights b;                            ///< of the result
  Weights error;                        ///< weights of the result minus those of the embedded method
  const double* safer_error = nullptr;  ///< the same for a second embedded method, of lower order; none: nullptr

  const double* row(int stage) const { return a + stage * (stage - 1) / 2; }
};

namespace tableaus {

/// Dormand, El-Mikkawy, Prince 1987, High-order embedded Runge-Kutta-Nystrom formulae, IMA J. Numer. Anal. 7: order 12(10), 17 stages.
extern const Tableau rkn12;
/// Hairer, Norsett, Wanner 1993, Solving Ordinary Differential Equations I, section II.10: DOP853, order 8(5,3), 12 stages.
extern const Tableau dop853;

}  // namespace tableaus

}  // namespace softffd
