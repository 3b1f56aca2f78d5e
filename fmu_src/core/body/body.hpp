/// The mechanical model of eq. (3): masses, springs, point damping; and where it is wanted, what keeps cells from folding. Constant during
/// a step.
#pragma once
#include <memory>
#include <optional>

#include "forces/springs.hpp"
#include "forces/volume.hpp"
#include "model/samples.hpp"

namespace softffd {

struct Body {
  Springs springs;
  Scalars mass;                    ///< (points) [kg], > 0
  Scalars damping;                 ///< (points) [N s/m], >= 0
  std::vector<bool> pinned;        ///< (points) moved by a pin, not by forces
  bool damped = false;             ///< any damping > 0, of points or along springs
  double fastest_damping = 0;      ///< rate at which damping changes velocities, at most [1/s]
  Scalars weight{};                ///< (points) [kg], what gravity pulls at
  Scalars inverse_mass{};          ///< (3 * points), axis by axis; 0 where pinned [1/kg]
  Scalars damping_rate{};          ///< (3 * points), damping / mass; 0 where pinned [1/s]
  double length = 1;               ///< largest side of the box [m]: the scale of every tolerance on positions
  std::optional<Volume> volume{};  ///< volume stiffness; most bodies have none
  Count version = 0;               ///< made new by whoever changes masses, stiffness, damping or the pinned points
  /// Of the surface, by which obstacles are met; null: by the control points.
  std::shared_ptr<const Samples> samples{};
  int points() const { return int(mass.size()); }

  /// f = forces of the springs and of the volume stiffness on the points at x [N], (points, 3).
  void internal_force(const Points& x, Points& f) const {
    springs.force(x, f);
    if (volume) volume->add_force(x, f);
  }
  /// Energy of the springs and of the volume stiffness at x [J].
  double elastic_energy(const Points& x) const { return springs.energy(x) + (volume ? volume->energy(x) : 0.0); }
};

/// What the dashpots take of points at x that move with v [W].
template <class V>
double dashpot_power(const Springs& springs, const Points& x, const V& v) {
  double power = 0;
  if (!springs.dashpots()) return power;
  for (const Springs::Row& row : springs.rows())
    for (int lane = 0; lane < row.lanes(); ++lane) {
      if (row.dashpot[lane] == 0) continue;
      const int p = row.begin + lane, q = p + row.offset;
      double along = 0, squared = kernels::smallest_square;
      for (int axis = 0; axis < 3; ++axis) {
        const double d = x(q, axis) - x(p, axis);
        along += d * (v(q, axis) - v(p, axis));
        squared += d * d;
      }
      power += row.dashpot[lane] * along * along / squared;
    }
  return power;
}

}  // namespace softffd
