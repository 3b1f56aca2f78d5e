/// Half kicks of a body with internal damping: velocities under forces that stay as they are, at positions that do,
///
///      M v' = f - D v - C v      for a time t,      D: point damping, C: the dashpots along the springs (springs.hpp).
///
/// C couples neighbours, so the kick is no number for each point as without it (kick.hpp). By the explicit method of Runge, Kutta and
/// Chebyshev of second order (Sommeijer, Shampine, Verwer 1997, RKC: an explicit solver for parabolic PDEs, J. Comput. Appl. Math. 88):
/// with s products by C it is stable for t times the fastest rate of damping up to 2/3 (s^2 - 1), so that strong damping costs its square
/// root, and no equations are solved. A velocity at which f = (D + C) v stays to rounding. What a dashpot gives its ends is opposite at
/// every stage: momentum and angular momentum are those of the outside forces exactly.
///
/// Pinned points keep their velocity for the dashpots' forces; what all forces would give them is still added, so that
/// mass times the change is the impulse their pin has to balance.
#pragma once
#include <vector>

#include "forces/body.hpp"

namespace softffd {

class DampedKick {
 public:
  explicit DampedKick(int points);
  /// For kicks of length t.
  void prepare(const Body& body, double t);
  /// v <- velocities after the kick from v0 at positions x; forces [N]: of the springs, with those of the dashpots at v0, from outside. All
  /// (points, 3).
  void apply(const Body& body, const Points& x, const Points& spring, const Points& inner, const Points& outside, const Points& v0,
             Points& v);
  /// Energy that damping takes in a kick from v0 to v [J].
  double loss(const Body& body, const Points& x, const Points& v0, const Points& v);
  int stages() const { return int(rows_.size()) + 1; }
  /// For a kick of length t of this body; of a kick the work is about so many evaluations of the spring forces.
  static int stages(const Body& body, double t);

 private:
  /// Y_j = (1 - mu - nu) Y_0 + mu Y_{j-1} + nu Y_{j-2} + step t F(Y_{j-1}) + first t F(Y_0), from the second stage on.
  struct Row {
    double mu, nu, step, first;
  };
  void hold_pins(const Points& v0, Points& v) const;
  /// slope = (slope - D v) / m.
  static void finish(const Body& body, const Points& v, Points& slope);

  double t_ = 0, first_ = 0;  ///< first: of F(Y_0) in Y_1
  std::vector<Row> rows_;
  std::vector<int> pinned_;
  Points moving_, start_slope_, slope_, before_, stage_;
};

}  // namespace softffd
