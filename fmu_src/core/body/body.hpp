/// The mechanical model of eq. (3): masses, point damping, and the energies that hold the points together. Constant during a step.
#pragma once
#include <algorithm>
#include <memory>
#include <vector>

#include "body/samples.hpp"
#include "forces/energy.hpp"
#include "forces/kernels.hpp"

namespace softffd {

struct Body {
  std::vector<std::shared_ptr<Energy>> energies;  ///< at least one; copies of a body share them
  Scalars mass;                                   ///< (points) [kg], > 0
  Scalars damping;                                ///< (points) [N s/m], >= 0
  std::vector<bool> pinned;                       ///< (points) moved by a pin, not by forces
  std::vector<bool> yielding{};                   ///< (points) by a pin whose part is free; empty: none
  std::vector<bool> not_yielding{};               ///< (points) by one that is not, where there are such
  bool explicit_alone = false;                    ///< there are no matrices for its lattice (matrix/lattice_matrix.hpp)
  bool damped = false;                            ///< any damping > 0, of points or along springs
  double fastest_drag = 0;                        ///< the largest rate at which the points' damping changes velocities,
  double fastest_damping = 0;                     ///< and all damping of a body at rest [1/s]
  Scalars weight{};                               ///< (points) [kg], what gravity pulls at
  Scalars inverse_mass{};                         ///< (3 * points), axis by axis; 0 where pinned [1/kg]
  Scalars damping_rate{};                         ///< (3 * points), damping / mass; 0 where pinned [1/s]
  double length = 1;                              ///< largest side of the box [m]: the scale of every tolerance on positions
  mutable Points scratch{};                       ///< (points, 3), of who uses it last
  Count version = 0;                              ///< made new by whoever changes masses, stiffness, damping or the pinned points
  /// Of the surface, by which obstacles are met; null: by the control points.
  std::shared_ptr<const Samples> samples{};
  int points() const { return int(mass.size()); }
  const std::vector<bool>& prescribed() const { return yielding.empty() ? pinned : not_yielding; }
  /// Nothing moves, or acts on, points of a pin that does not yield.
  void hold_prescribed(Points& values) const {
    for (int p = 0; p < points(); ++p)
      if (pinned[p] && (yielding.empty() || !yielding[p])) set_row(values, p, Vec3::Zero());
  }

  /// f = forces of all energies on the points at x [N], (points, 3).
  void internal_force(const Points& x, Points& f) const {
    energies.front()->set_force(x, f);
    for (std::size_t i = 1; i < energies.size(); ++i) energies[i]->add_force(x, f);
  }
  /// Of all energies at x [J].
  double elastic_energy(const Points& x) const {
    return sum([&](const Energy& each) { return each.energy(x); });
  }
  /// f -= the linearisation's matrix at x times u [N]; u [m], (points, 3).
  void subtract_product(const Points& x, const Linearisation& of, const Points& u, Points& f) const {
    for (const auto& each : energies) each->subtract_product(x, of, u, f);
  }
  /// Largest stiffness between two points [N/m].
  double largest_stiffness() const {
    double largest = 0;
    for (const auto& each : energies) largest = std::max(largest, each->largest_stiffness());
    return largest;
  }

  /// Whether there are dashpots; the smallest and the largest ratio of one to its stiffness [s].
  bool dashpots() const { return longest_time() > 0; }
  double shortest_time() const {
    double shortest = energies.front()->shortest_time();
    for (const auto& each : energies) shortest = std::min(shortest, each->shortest_time());
    return shortest;
  }
  double longest_time() const {
    double longest = 0;
    for (const auto& each : energies) longest = std::max(longest, each->longest_time());
    return longest;
  }
  /// Bound of the rate at which damping changes velocities of points at x [1/s].
  double damping_rate_at(const Points& x) const {
    double rate = fastest_damping;
    for (const auto& each : energies) rate = std::max(rate, fastest_drag + each->dashpot_rate(x, mass, prescribed()));
    return rate;
  }
  bool has_deformed(const Points& x, const Points& x0) const {
    return std::any_of(energies.begin(), energies.end(), [&](const auto& each) { return each->has_deformed(x, x0); });
  }
  /// f -= what the dashpots exert on points at x that move with v [N] (Energy::add_dashpot_force).
  void add_dashpot_force(const Points& x, const Points& v, Points& f, double drift = 0) const {
    for (const auto& each : energies) each->add_dashpot_force(x, v, f, drift);
  }
  /// What the dashpots take of points at x that move with v [W].
  double dashpot_power(const Points& x, const Points& v) const {
    return sum([&](const Energy& each) { return each.dashpot_power(x, v); });
  }

  /// A pass that moves the points too; null unless all forces are those of one energy that offers it.
  const FusedPass* fused() const { return energies.size() == 1 ? energies.front()->fused() : nullptr; }

 private:
  template <class Value>
  double sum(const Value& value) const {
    double sum = 0;
    for (const auto& each : energies) sum += value(*each);
    return sum;
  }
};

}  // namespace softffd
