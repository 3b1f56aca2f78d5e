/// The mechanical model of eq. (3): masses, nodal viscous drag, and the energies that couple the points. Constant during a step.
#pragma once
#include <algorithm>
#include <memory>
#include <vector>

#include "body/samples.hpp"
#include "forces/energy.hpp"
#include "forces/kernels.hpp"

namespace softffd {

struct Body {
  std::vector<std::shared_ptr<Energy>> energies;  ///< at least one energy; copies of a body share the energies
  Scalars mass;                                   ///< (points) [kg], > 0
  Scalars damping;                                ///< nodal viscous drag (points) [N s/m], >= 0
  std::vector<bool> pinned;                       ///< (points) true if a pin moves the point instead of the forces
  std::vector<bool> yielding{};                   ///< (points) true if pinned to a frame that is a free part; empty: no such pin
  std::vector<bool> not_yielding{};               ///< (points) true if pinned to any other frame; filled only if `yielding` is
  bool explicit_alone = false;                    ///< no matrices exist for the lattice (matrix/lattice_matrix.hpp)
  bool damped = false;                            ///< true if any damping is > 0, nodal drag or dashpots along springs
  double fastest_drag = 0;                        ///< largest rate at which nodal drag changes velocities [1/s]
  double fastest_damping = 0;                     ///< the same rate for all damping, of a body at rest [1/s]
  Scalars weight{};                               ///< (points) [kg], mass on which gravity acts
  Scalars inverse_mass{};                         ///< (3 * points), axis by axis; 0 where pinned [1/kg]
  Scalars damping_rate{};                         ///< (3 * points), damping / mass; 0 where pinned [1/s]
  double length = 1;                              ///< largest side of the box [m]: the scale of every tolerance on positions
  mutable Points scratch{};                       ///< (points, 3) workspace; the last user owns the content
  Count version = 0;                              ///< changes whenever masses, stiffness, damping or the pinned points change
  /// Samples of the surface, at which the body meets obstacles; null: the control points meet obstacles.
  std::shared_ptr<const Samples> samples{};
  int points() const { return int(mass.size()); }
  const std::vector<bool>& prescribed() const { return yielding.empty() ? pinned : not_yielding; }
  /// Sets the values to zero at points with prescribed motion (of pins that do not yield): nothing moves these points or acts on them.
  void hold_prescribed(Points& values) const {
    for (int p = 0; p < points(); ++p)
      if (pinned[p] && (yielding.empty() || !yielding[p])) set_row(values, p, Vec3::Zero());
  }

  /// f = forces of all energies on the points at x [N], (points, 3).
  void internal_force(const Points& x, Points& f) const {
    energies.front()->set_force(x, f);
    for (std::size_t i = 1; i < energies.size(); ++i) energies[i]->add_force(x, f);
  }
  /// Returns the elastic energy of all energies at x [J].
  double elastic_energy(const Points& x) const {
    return sum([&](const Energy& each) { return each.energy(x); });
  }
  /// f -= K u [N], where K is the matrix of the linearisation at x; u [m] and f are (points, 3).
  void subtract_product(const Points& x, const Linearisation& of, const Points& u, Points& f) const {
    for (const auto& each : energies) each->subtract_product(x, of, u, f);
  }
  /// Returns the largest stiffness between two points [N/m].
  double largest_stiffness() const {
    double largest = 0;
    for (const auto& each : energies) largest = std::max(largest, each->largest_stiffness());
    return largest;
  }

  /// True if there are dashpots. The two functions below return the smallest and the largest ratio of a dashpot to its stiffness [s].
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
  /// Returns an upper bound of the rate at which damping changes velocities of points at x [1/s].
  double damping_rate_at(const Points& x) const {
    double rate = fastest_damping;
    for (const auto& each : energies) rate = std::max(rate, fastest_drag + each->dashpot_rate(x, mass, prescribed()));
    return rate;
  }
  bool has_deformed(const Points& x, const Points& x0) const {
    return std::any_of(energies.begin(), energies.end(), [&](const auto& each) { return each->has_deformed(x, x0); });
  }
  /// f -= forces of the dashpots on points at x with velocities v [N] (Energy::add_dashpot_force).
  void add_dashpot_force(const Points& x, const Points& v, Points& f, double drift = 0) const {
    for (const auto& each : energies) each->add_dashpot_force(x, v, f, drift);
  }
  /// Returns the power that the dashpots take from points at x with velocities v [W].
  double dashpot_power(const Points& x, const Points& v) const {
    return sum([&](const Energy& each) { return each.dashpot_power(x, v); });
  }

  /// Returns the pass that also moves the points; null unless all forces are those of one energy that offers such a pass.
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
