/// The loops of the solid's energy over its patches, on plain arrays, chosen for the machine's instructions (machine/instructions.hpp).
#pragma once
#include <array>
#include <cstddef>

#include "model/lobatto.hpp"

namespace softffd::kernels {

/// J0: a node resists on its own below this relative volume [1], because the projection alone would not see its loss of volume.
inline constexpr double least_volume = 0.3;

/// Coefficients of the sums and differences of nodal values in the derivative along a line of nodes [1/m] (patch_rows.hpp).
struct LineShape {
  double outer_at_end, inner_at_end, middle, root, even;
  /// side: length of the patch along the line [m].
  constexpr explicit LineShape(double side = 1)
      : outer_at_end(3.5 / side),
        inner_at_end(2.5 * lobatto::root5 / side),
        middle(0.5 / side),
        root(0.5 * lobatto::root5 / side),
        even(2.5 / side) {}
};

/// Data that all patches of a body share: derivatives along the axes, and the weights of the quadrature.
struct PatchShape {
  double along[4][4]{};      ///< d/dx along a row, [s][i]: derivative at node i by the value at node s [1/m]
  double back[4][4]{};       ///< the same transposed
  double across[2][4][4]{};  ///< d/dy and d/dz, [i][s]
  LineShape y, z;
  double weight[16][4]{};    ///< w, row j + 4 k [m3]
  double projector[4][4]{};  ///< Pi along x: [s][i]
};

struct SolidBody {
  std::array<int, 3> patches;          ///< number of patches along each axis
  std::ptrdiff_t points = 0;           ///< distance from one coordinate to the next [numbers]
  std::ptrdiff_t line = 0, layer = 0;  ///< distance from one y, and from one z, to the next [numbers]
  PatchShape shape;
  double mu = 0, lambda = 0;  ///< Lame's constants [Pa]
};

/// Count of numbers kept per patch for its viscosity: deformation gradients F, nine numbers per node. They begin at a whole register.
inline constexpr int kept_numbers = 9 * 64;
/// f -= the energy's gradient at x; both (3 * points). kept: receives F of all patches; null: not wanted.
extern void (*const subtract_elastic)(const SolidBody& body, const double* x, double* f, double* kept);
extern void (*const find_gradients)(const SolidBody& body, const double* x, double* kept);
/// f -= the forces of a viscosity of this time [s] at the gradients F in `kept` and velocities v; drift: see forces/energy.hpp.
extern void (*const subtract_viscous)(const SolidBody& body, double time, double drift, double* kept, const double* v, double* f);
/// f -= (second derivatives at x + per_time times the viscosity's matrix) u. The pressure at a node may take more from the stiffness than
/// a rotation needs; softening is the fraction of this excess that counts, from 0 to 1.
extern void (*const subtract_tangent)(const SolidBody& body, double softening, double per_time, const double* x, const double* u,
                                      double* f);
/// The same matrix of one patch, whose first node is the first of x, for its 64 nodes with p >= q: of[3 c + e].at[q][p] couples
/// coordinate c of p with coordinate e of q. The spare numbers keep the nine entries from sharing cache sets.
struct PatchMatrix {
  struct Entry {
    double at[64][64], spare[8];
  };
  Entry of[9];
};
extern void (*const patch_matrix)(const SolidBody& body, double softening, double per_time, const double* x, PatchMatrix& matrix);
/// volumes = J - 1 at the nodes of one patch, whose first node is the first of x.
extern void (*const patch_volumes)(const SolidBody& body, const double* x, double volumes[64]);
/// Return the energy [J], and the dissipated power per second of the viscosity's time [W/s].
extern double (*const solid_energy)(const SolidBody& body, const double* x);
extern double (*const viscous_power)(const SolidBody& body, const double* x, const double* v);

/// Quantities that bound the matrices of a patch (solid.hpp).
struct PatchBounds {
  double curvature;            ///< the largest alpha [Pa]
  double unevenness, mean;     ///< of the cofactors c: largest |c - c0|^2, and |c0|_2^2
  double stretch;              ///< largest |F|_2^2
  double of_stretch, average;  ///< largest |F - F0|^2, and |F0|_2^2
};
/// bounds: (patches), x fastest.
extern void (*const bound_patches)(const SolidBody& body, const double* x, PatchBounds* bounds);

}  // namespace softffd::kernels
