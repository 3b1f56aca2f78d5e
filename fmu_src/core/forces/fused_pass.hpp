/// Forces, kicks and a drift in one pass over the points: what an energy may offer where nothing stands between the forces of a step and
/// the next drift, so that a step reads and writes each position and velocity once.
#pragma once
#include <array>

#include "model/types.hpp"

namespace softffd {

/// Kicks by the forces at x, one after the other, then a drift: v <- a v + b (f + outside) for each kick; x <- x + h v. What is the same
/// number for all points need not be read for each of them, which is a third of what a step of a large lattice reads and writes.
struct Stage {
  struct Kick {
    const double *a, *b;  ///< (points)
    bool even = false;    ///< a and b are each the same for all points
  };
  std::array<Kick, 2> kicks;
  int count;                  ///< of kicks
  double h;                   ///< [s]
  bool even_outside = false;  ///< the outside forces are the same on all points
};

class FusedPass {
 public:
  static constexpr int lanes = 8;  ///< points of a block

  /// What is kept of the moment between two kicks.
  struct Between {
    const Count* until = nullptr;  ///< of blocks of points for which this is not less than `now`; null: of none
    Count now = 0;
    double* force = nullptr;  ///< the forces at x (3 * points)
  };

  virtual ~FusedPass() = default;
  /// The stage from positions x and velocities `before`, to positions `next` and velocities v; outside forces [N]; all (points, 3).
  /// `before` and v may be the same; of blocks that are kept those after the first kick go to `before`.
  virtual void advance(const Stage& stage, const Points& outside, const Points& x, Points& before, Points& v, Points& next,
                       const Between& between) const = 0;
  void advance(const Stage& stage, const Points& outside, const Points& x, Points& v, Points& next) const {
    advance(stage, outside, x, v, v, next, {});
  }
};

}  // namespace softffd
