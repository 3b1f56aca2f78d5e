/// Regions of control points whose material differs from the rest of the body: their overrides for springs and for cells.
#pragma once
#include <optional>
#include <vector>

#include "forces/springs.hpp"

namespace softffd {

/// Overrides of a [[region]]; an absent value leaves the material as it is.
struct Region {
  std::vector<int> points;
  std::optional<double> stiffness{};         ///< of springs with both ends among the points, >= 0 [N/m]
  std::optional<double> damping{};           ///< nodal viscous drag of the points, >= 0 [N s/m]
  std::optional<double> modulus{};           ///< of the cells with all corners among the points, > 0 [Pa]
  std::optional<double> internal_damping{};  ///< of these springs, or of these cells if the springs follow from a modulus, >= 0 [s]
};

/// Sets springs from the values of the whole body and of its regions; later regions win. Allocates no memory after construction.
class Regions {
 public:
  Regions(const Lattice& lattice, const std::vector<Region>& regions);

  /// Sets springs of a given stiffness; time: ratio of a dashpot to its stiffness [s].
  void set_stiffness(const Stiffness& stiffness, double time, Springs& springs) const;
  /// Sets springs that follow from a modulus [Pa]; time: the same ratio [s].
  void set_modulus(double modulus, double time, Springs& springs);

 private:
  struct Cells {
    std::vector<int> numbers;
    double value;
  };
  static void fill(double of_all, const std::vector<Cells>& overrides, Scalars& values);

  std::vector<SpringOverride> stiffness_, dashpots_;
  std::vector<Cells> modulus_, time_;
  Scalars modulus_of_cells_, time_of_cells_;
};

}  // namespace softffd
