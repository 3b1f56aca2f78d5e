/// Half kicks of a body with internal damping. Velocities change under constant forces, at constant positions:
///
///      M v' = f - D v - C v      for a time t,      D: point damping, C: the dashpots along the springs (springs.hpp).
///
/// C couples neighbours. A kick is therefore not one number for each point, as it is without C (kick.hpp). With A = M^-1 (C + D) and the
/// acceleration a0 at the beginning of the kick, the exact velocity at its end is
///
///      v = v0 + t (a0 - t A y),      y = psi(t A) a0,      psi(z) = (exp(-z) - 1 + z) / z^2,
///
/// psi is interpolated by a polynomial on the interval of A's eigenvalues, at Chebyshev points and the two ends. This takes s products by
/// A in all (the idea: Tal-Ezer, Kosloff 1984, J. Chem. Phys. 81). Whatever the polynomial, v is second-order accurate, and a velocity
/// with f = (D + C) v stays constant up to rounding. s grows with the square root of t times the fastest damping rate: strong damping
/// costs little, and no equations are solved. In every product a dashpot acts on its two ends with opposite forces: momentum and angular
/// momentum are exactly those of the outside forces.
///
/// Bodies that turn (methods/damped_leapfrog.hpp) require that strong damping leaves next to nothing of what it damps. Of a motion with z
/// = t times its damping rate, at most 1 / z is left; the number of products ensures this. Runge-Kutta-Chebyshev methods need half as many
/// products, but leave between a third and all of the motion.
///
/// In the dashpot forces, pinned points keep their velocity. The velocity change that all forces would give a pinned point is still added,
/// so that mass times the change is the impulse that the pin has to balance.
#pragma once
#include <vector>

#include "body/body.hpp"

namespace softffd {

class DampedKick {
 public:
  explicit DampedKick(int points);
  /// Prepares kicks of length t [s], for a body whose damping changes velocities at most at this rate [1/s].
  void prepare(const Body& body, double t, double rate);
  /// Sets v to the velocities after the kick from v0 at positions x. inner, outside: forces at the beginning of the kick, of springs and
  /// dashpots and from outside [N]. All arrays are (points, 3).
  void apply(const Body& body, const Points& x, const Points& inner, const Points& outside, const Points& v0, Points& v);
  /// Returns the energy that damping takes in the last kick, from v0 to v under these forces [J]: their work on the way t (v0 + t y) minus
  /// the energy gained. drifted: positions follow from the velocities before the kick instead of those after it; the work is then that on
  /// the way back, t (v - t y). Both ways are t (v0 + v) / 2 without damping; with strong damping the first is t v, the second t v0.
  double loss(const Body& body, const Points& spring, const Points& outside, const Points& v0, const Points& v, bool drifted);
  int products() const { return int(coefficients_.size()) + 1; }
  /// Returns the number for a kick of length t of this body. A kick costs about as much as this many evaluations of the spring forces.
  static int products(const Body& body, double t) { return products(t * body.fastest_damping); }

 private:
  static int products(double reach);
  void hold_pins(const Points& v0, Points& v) const;
  /// Sets the velocities v of pinned points to zero, then out = t A v.
  void multiply(const Body& body, const Points& x, Points& v, Points& out) const;

  double t_ = -1;
  Count version_ = -1;                ///< version of the body
  double rate_ = 0;                   ///< fastest damping rate [1/s]
  double reach_ = 0;                  ///< t times the fastest rate
  std::vector<double> coefficients_;  ///< coefficients of psi's polynomial in Chebyshev's T_0, T_1 ... of 1 - 2 t A / reach
  std::vector<int> pinned_;
  Scalars scale_, opposed_;                             ///< scale_ takes C + D to -t A; opposed_ is -D
  Points acceleration_, now_, before_, product_, sum_;  ///< sum_: y
};

}  // namespace softffd
