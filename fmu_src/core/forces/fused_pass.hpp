/// Forces, kicks and a drift in one pass over the points. An energy may offer such a pass for steps in which nothing comes between the
/// forces and the next drift; a step then reads and writes each position and velocity once.
#pragma once
#include <array>

#include "model/types.hpp"

namespace softffd {

/// One or two kicks by the forces at x, each v <- a v + b (f + outside), followed by a drift x <- x + h v. A number that is the same for
/// all points need not be read for each of them; such numbers are a third of what a step of a large lattice reads and writes.
struct Stage {
  struct Kick {
    const double *a, *b;  ///< (points)
    bool even = false;    ///< a and b are each the same for all points
  };
  std::array<Kick, 2> kicks;
  int count;                  ///< number of kicks
  double h;                   ///< time of the drift [s]
  bool even_outside = false;  ///< the outside forces are the same on all points
};

class FusedPass {
 public:
  static constexpr int lanes = 8;  ///< points per block

  /// Selects the blocks of points whose state between two kicks is kept.
  struct Between {
    const Count* until = nullptr;  ///< (blocks) a block is kept if this is at least `now`; null: none is kept
    Count now = 0;
    double* force = nullptr;  ///< receives the forces at x (3 * points)
  };

  virtual ~FusedPass() = default;
  /// Carries out the stage from positions x and velocities `before` to positions `next` and velocities v, with outside forces [N]; all
  /// (points, 3). `before` and v may be the same. For blocks that are kept, the velocities after the first kick are written to `before`.
  virtual void advance(const Stage& stage, const Points& outside, const Points& x, Points& before, Points& v, Points& next,
                       const Between& between) const = 0;
  void advance(const Stage& stage, const Points& outside, const Points& x, Points& v, Points& next) const {
    advance(stage, outside, x, v, v, next, {});
  }
};

}  // namespace softffd
