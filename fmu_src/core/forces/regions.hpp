/// Where a material is another than in the rest of the body: what regions of control points override, of springs and of cells.
#pragma once
#include <optional>
#include <vector>

#include "forces/springs.hpp"

namespace softffd {

/// Overrides of a [[region]]; absent ones leave what is there.
struct Region {
  std::vector<int> points;
  std::optional<double> stiffness{};         ///< of springs with both ends among the points, >= 0 [N/m]
  std::optional<double> damping{};           ///< of the points, >= 0 [N s/m]
  std::optional<double> modulus{};           ///< of the cells with all corners among the points, > 0 [Pa]
  std::optional<double> internal_damping{};  ///< of the springs, or, of a modulus, of the cells, >= 0 [s]
};

/// Sets springs by the values of the whole body and of its regions, of which later ones win. Asks for no memory once it is made.
class Regions {
 public:
  Regions(const Lattice& lattice, const std::vector<Region>& regions);

  /// Springs of a stiffness; time: of their dashpots [s].
  void set_stiffness(const Stiffness& stiffness, double time, Springs& springs) const;
  /// Springs of a modulus [Pa].
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
