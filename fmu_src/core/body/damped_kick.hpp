/// Half kicks of a body with internal damping: velocities under forces that stay as they are, at positions that do,
///
///      M v' = f - D v - C v      for a time t,      D: point damping, C: the dashpots along the springs (springs.hpp).
///
/// C couples neighbours, so the kick is no number for each point as without it (kick.hpp). With A = M^-1 (C + D) and a0 the acceleration at
/// its beginning, its exact end is
///
///      v = v0 + t (a0 - t A y),      y = psi(t A) a0,      psi(z) = (exp(-z) - 1 + z) / z^2,
///
/// of which psi is interpolated by a polynomial where A's eigenvalues lie, at Chebyshev's points and their ends: s products by A in all
/// (the idea: Tal-Ezer, Kosloff 1984, J. Chem. Phys. 81). Whatever the polynomial, v is right to second order and a velocity at which f =
/// (D + C) v stays to rounding. s grows with the square root of t times the fastest rate of damping, so that strong damping costs little,
/// and no equations are solved. What a dashpot gives its ends is opposite in every product: momentum and angular momentum are those of the
/// outside forces exactly.
///
/// That strong damping leaves next to nothing of what it damps matters to bodies that turn (methods/damped_leapfrog.hpp): of a motion with
/// z = t times its rate at most 1 / z is left, which the number of products sees to. Methods of Runge, Kutta and Chebyshev need half of
/// them, but leave a third to one.
///
/// Pinned points keep their velocity for the dashpots' forces; what all forces would give them is still added, so that
/// mass times the change is the impulse their pin has to balance.
#pragma once
#include <vector>

#include "body/body.hpp"

namespace softffd {

class DampedKick {
 public:
  explicit DampedKick(int points);
  /// For kicks of length t, where damping changes velocities at this rate at most [1/s].
  void prepare(const Body& body, double t, double rate);
  /// v <- velocities after the kick from v0 at positions x; forces at its beginning [N]: of springs and dashpots, from outside. All
  /// (points, 3).
  void apply(const Body& body, const Points& x, const Points& inner, const Points& outside, const Points& v0, Points& v);
  /// Energy that damping takes in the last kick, from v0 to v by these forces [J]: their work on its way, t (v0 + t y), less what the body
  /// has gained. drifted: positions follow from the velocities before the kick, not from those after it; then their work is that on the
  /// way back, t (v - t y). Both are t (v0 + v) / 2 without damping; with strong damping the one is t v, the other t v0.
  double loss(const Body& body, const Points& spring, const Points& outside, const Points& v0, const Points& v, bool drifted);
  int products() const { return int(shares_.size()) + 1; }
  /// For a kick of length t of this body; of a kick the work is about so many evaluations of the spring forces.
  static int products(const Body& body, double t) { return products(t * body.fastest_damping); }

 private:
  static int products(double reach);
  void hold_pins(const Points& v0, Points& v) const;
  /// out = t A v, with the pinned points of v at rest, which this makes them.
  void multiply(const Body& body, const Points& x, Points& v, Points& out) const;

  double t_ = -1;
  Count version_ = -1;          ///< of the body
  double rate_ = 0;             ///< the fastest [1/s]
  double reach_ = 0;            ///< t times the fastest rate
  std::vector<double> shares_;  ///< of psi's polynomial, of Chebyshev's T_0, T_1 ... of 1 - 2 t A / reach
  std::vector<int> pinned_;
  Scalars scale_, opposed_;                             ///< of what C + D take to -t A; -D
  Points acceleration_, now_, before_, product_, sum_;  ///< the last: y
};

}  // namespace softffd
