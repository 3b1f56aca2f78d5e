/// The loops of the solid's energy over its patches: plain arrays, chosen for the machine's instructions (machine/instructions.hpp).
#pragma once
#include <array>
#include <cstddef>

#include "model/lobatto.hpp"

namespace softffd::kernels {

/// J0: relative volume below which a node resists on its own, which the projection would not see.
inline constexpr double least_volume = 0.3;

/// Of the derivative along a line of nodes, what multiplies sums and differences of them [1/m] (patch_rows.hpp).
struct LineShape {
  double outer_at_end, inner_at_end, middle, root, even;
  /// side: of the patch [m].
  constexpr explicit LineShape(double side = 1)
      : outer_at_end(3.5 / side),
        inner_at_end(2.5 * lobatto::root5 / side),
        middle(0.5 / side),
        root(0.5 * lobatto::root5 / side),
        even(2.5 / side) {}
};

/// What is the same for all patches of a body: derivatives along the axes, and the weights of the quadrature.
struct PatchShape {
  double along[4][4]{};      ///< d/dx of a row, [s][i]: of node i by the number at node s [1/m]
  double back[4][4]{};       ///< the same transposed
  double across[2][4][4]{};  ///< d/dy and d/dz, [i][s]
  LineShape y, z;
  double weight[16][4]{};    ///< w, row j + 4 k [m3]
  double projector[4][4]{};  ///< Pi along x: [s][i]
};

struct SolidBody {
  std::array<int, 3> patches;          ///< along the axes
  std::ptrdiff_t points = 0;           ///< from one coordinate to the next, in numbers
  std::ptrdiff_t line = 0, layer = 0;  ///< from one y, one z to the next
  PatchShape shape;
  double mu = 0, lambda = 0;  ///< Lame's constants [Pa]
};

/// Numbers of the deformation gradients F of a patch that are kept for its viscosity: nine at each node. They begin at a whole register.
inline constexpr int kept_numbers = 9 * 64;
/// f -= the energy's gradient at x. All (3 * points). kept: F of the patches, where they are asked for.
extern void (*const subtract_elastic)(const SolidBody& body, const double* x, double* f, double* kept);
extern void (*const find_gradients)(const SolidBody& body, const double* x, double* kept);
/// f -= what viscosity of this time [s] exerts where F are these, at velocities v; drift: forces/energy.hpp.
extern void (*const subtract_viscous)(const SolidBody& body, double time, double drift, double* kept, const double* v, double* f);
/// f -= (second derivatives at x + per_time times the viscosity's matrix) u. softening: of what the pressure at a node takes from the
/// stiffness beyond what a rotation needs, from 0 to 1.
extern void (*const subtract_tangent)(const SolidBody& body, double softening, double per_time, const double* x, const double* u,
                                      double* f);
/// The same matrix of one patch, whose first node is the first of x, for its nodes p >= q, 64 of them: of[3 c + e].at[q][p] is by
/// coordinate c of p and e of q. Their spare numbers keep the nine off each other's cache sets.
struct PatchMatrix {
  struct Entry {
    double at[64][64], spare[8];
  };
  Entry of[9];
};
extern void (*const patch_matrix)(const SolidBody& body, double softening, double per_time, const double* x, PatchMatrix& matrix);
/// J - 1 at the nodes of one patch, whose first node is the first of x.
extern void (*const patch_volumes)(const SolidBody& body, const double* x, double volumes[64]);
/// [J], and of viscosity of one second [W s].
extern double (*const solid_energy)(const SolidBody& body, const double* x);
extern double (*const viscous_power)(const SolidBody& body, const double* x, const double* v);

/// What bounds the matrices of a patch (solid.hpp).
struct PatchBounds {
  double curvature;            ///< the largest alpha [Pa]
  double unevenness, mean;     ///< of the cofactors c: the largest |c - c0|^2, and |c0|_2^2
  double stretch;              ///< the largest |F|_2^2,
  double of_stretch, average;  ///< and the largest |F - F0|^2, |F0|_2^2
};
/// bounds: (patches), x fastest.
extern void (*const bound_patches)(const SolidBody& body, const double* x, PatchBounds* bounds);

}  // namespace softffd::kernels
