/// Gauss-Lobatto points: the points that carry the state of a body of finite elements.
///
/// The body is cut into patches of 3 x 3 x 3 cells. In each patch the deformation is the cubic Bezier volume of the 4 x 4 x 4 control
/// points q. The same deformation interpolates the positions y of 4 x 4 x 4 material points, the nodes, at the Gauss-Lobatto points t_i of
/// each axis:
///
///      y = A q,  A_ij = B_j(t_i)  (Bernstein polynomials),      0, (1 - 1/sqrt 5) / 2, (1 + 1/sqrt 5) / 2, 1.
///
/// Patches share the nodes of their faces. The nodes are also the points of the quadrature, whose weights 1/12, 5/12, 5/12, 1/12 are exact
/// to degree five: the mass matrix is diagonal, and the masses of a box have its centre and inertia.
#pragma once
#include <array>

#include "model/lattice.hpp"

namespace softffd::lobatto {

/// Number of nodes of a patch along an axis.
inline constexpr int nodes = 4;
/// Positions of the nodes, and weights of the quadrature, as fractions of the patch's side [1].
inline constexpr double root5 = 2.2360679774997896964;
inline constexpr std::array<double, nodes> places{0, (1 - 1 / root5) / 2, (1 + 1 / root5) / 2, 1};
inline constexpr std::array<double, nodes> weights{1.0 / 12, 5.0 / 12, 5.0 / 12, 1.0 / 12};
/// l_j'(t_i) of the Lagrange polynomials on [0, 1]: derivative[i][j].
inline constexpr double derivative[nodes][nodes] = {{-6, 2.5 * (root5 + 1), -2.5 * (root5 - 1), 1},
                                                    {-0.5 * (root5 + 1), 0, root5, -0.5 * (root5 - 1)},
                                                    {0.5 * (root5 - 1), -root5, 0, 0.5 * (root5 + 1)},
                                                    {-1, 2.5 * (root5 - 1), -2.5 * (root5 + 1), 6}};
/// Factors in A^-1 of the nearer and the farther inner node for an inner control point; those of the two ends are -1 and 1/3.
inline constexpr double near = (root5 * places[2]) / 0.6, far = -(root5 * places[1]) / 0.6;

/// True if an axis of this many points consists of whole patches.
constexpr bool whole(int points) { return points >= nodes && (points - 1) % (nodes - 1) == 0; }
constexpr int patches(int points) { return (points - 1) / (nodes - 1); }

/// Returns the position of node i of an axis of n nodes, from 0 to 1.
double place(int i, int n);
/// Returns the weights (n) of the nodes at t, from 0 to 1: Lagrange polynomials of the patch. They sum to one and reproduce positions.
Scalars interpolation(double t, int n);
/// Returns the fraction of the box's volume that each node stands for, (points). The fractions sum to one.
Scalars volume_fractions(const Lattice& lattice);

/// q = A^-1 y along each axis, in place, for one number per node, (points).
void to_control_points(const Lattice& lattice, double* values);
/// The same for positions or velocities; and f_y = A^-T f_q: forces on nodes that do the work of forces on control points; (points, 3).
void to_control_points(const Lattice& lattice, const Points& nodes, Points& control_points);
void to_nodes(const Lattice& lattice, Points& forces);

}  // namespace softffd::lobatto
