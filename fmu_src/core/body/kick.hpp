/// Half kicks: the update of the velocity in a step, v <- a v + b f, over half an internal step, with point damping.
///
/// With g = d h / (2 m) the opening half is explicit in the damping and the closing half implicit,
///
///      open: v <- (1 - g) v + (h/2) f/m          close: v <- (v + (h/2) f/m) / (1 + g),
///
/// so that a closing and the next opening half kick together are the central difference of eq. (13), v <- ((1 - g) v + h f/m) / (1 + g),
/// second order and stable for any damping. For g > 1 the factor 1 - g is negative and the velocity would alternate in sign. Both halves
/// then use v <- E v + (1 - E) f/d with E = 1 / (1 + g + g^2/2), the second-order Pade approximation of exp(-g) that vanishes for large g:
/// the terminal velocity f/d is exact.
#pragma once
#include "body/body.hpp"
#include "model/arithmetic.hpp"

namespace softffd {

/// v <- a v + b f for all coordinates, (3 * points) each; without damping a is 1.
struct KickCoefficients {
  explicit KickCoefficients(int points) : a(Scalars::Zero(3 * points)), b(a) {}
  /// f = spring + outside forces [N].
  void apply(const Points& spring, const Points& outside, Points& v) const;
  Stage::Kick kick() const { return {a.data(), b.data(), even}; }
  Scalars a, b;
  bool even = false;  ///< a and b are each the same for all points, as found by `find_even`
  void find_even() { even = all_alike(a) && all_alike(b); }
};

class HalfKicks {
 public:
  explicit HalfKicks(int points) : open_(points), close_(points), opening_mass_(points), closing_mass_(points), weak_damping_(points) {}
  /// Coefficients for internal step h; kept while neither h nor the body changes.
  void prepare(const Body& body, double h);
  /// Takes only the masses of the body, for the kicks of damped_kick.hpp.
  void take_masses(const Body& body);

  /// Sets v and x by the opening half kick from v0 and the drift after it from x0.
  void open(const Points& spring, const Points& external, const Points& v0, const Points& x0, Points& v, Points& x) const;
  void close(const Points& spring, const Points& external, Points& v) const { close_.apply(spring, external, v); }

  /// Closing half kick, next opening one and drift after it. even_outside: the outside forces are the same on all points.
  Stage stage(bool even_outside) const { return {{close_.kick(), open_.kick()}, 2, h_, even_outside}; }

  /// Impulse that is equivalent to a unit velocity change right after the half kick, (points) [N s per m/s]: (h/2) / b; after take_masses,
  /// the mass.
  const Scalars& opening_mass() const { return opening_mass_; }
  const Scalars& closing_mass() const { return closing_mass_; }
  /// Point damping of the pinned points and of those with g <= 1, (points) [N s/m]; 0 elsewhere.
  const Scalars& weak_damping() const { return weak_damping_; }
  bool any_strong() const { return any_strong_; }  ///< some point that is not pinned has g > 1

 private:
  KickCoefficients open_, close_;
  Scalars opening_mass_, closing_mass_, weak_damping_;
  bool any_strong_ = false;
  double h_ = -1;
  Count version_ = -1;  ///< of the body
};

}  // namespace softffd
