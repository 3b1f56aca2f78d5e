/// Gauss-Lobatto points: where the state of a body of finite elements stands.
///
/// The body is cut into patches of 3 x 3 x 3 cells. In each the deformation is the cubic Bezier volume of its 4 x 4 x 4 control points q,
/// and it is as well the interpolation of the places y of 4 x 4 x 4 points of the material, its nodes, at the Gauss-Lobatto points t_i of
/// each axis:
///
///      y = A q,  A_ij = B_j(t_i)  (Bernstein polynomials),      0, (1 - 1/sqrt 5) / 2, (1 + 1/sqrt 5) / 2, 1.
///
/// Patches share the nodes of their faces. The nodes are the points of the quadrature too, whose weights 1/12, 5/12, 5/12, 1/12 are exact
/// to degree five: masses are diagonal, those of a box with its centre and inertia.
#pragma once
#include <array>

#include "model/lattice.hpp"

namespace softffd::lobatto {

/// Nodes of a patch along an axis.
inline constexpr int nodes = 4;
/// Of the patch's side [1].
inline constexpr double root5 = 2.2360679774997896964;
inline constexpr std::array<double, nodes> places{0, (1 - 1 / root5) / 2, (1 + 1 / root5) / 2, 1};
inline constexpr std::array<double, nodes> weights{1.0 / 12, 5.0 / 12, 5.0 / 12, 1.0 / 12};
/// l_j'(t_i) of the Lagrange polynomials, on [0, 1].
inline constexpr double derivative[nodes][nodes] = {{-6, 2.5 * (root5 + 1), -2.5 * (root5 - 1), 1},
                                                    {-0.5 * (root5 + 1), 0, root5, -0.5 * (root5 - 1)},
                                                    {0.5 * (root5 - 1), -root5, 0, 0.5 * (root5 + 1)},
                                                    {-1, 2.5 * (root5 - 1), -2.5 * (root5 + 1), 6}};
/// A^-1 for the two control points in the middle: of the nodes in the middle, the near one and the far one, and of the ends.
inline constexpr double near = (root5 * places[2]) / 0.6, far = -(root5 * places[1]) / 0.6;

/// Whether an axis of so many points is made of whole patches.
constexpr bool whole(int points) { return points >= nodes && (points - 1) % (nodes - 1) == 0; }
constexpr int patches(int points) { return (points - 1) / (nodes - 1); }

/// Place of node i of an axis of n, from 0 to 1.
double place(int i, int n);
/// Weights (n) of the nodes at the place t, from 0 to 1: Lagrange polynomials of its patch. They sum to one and reproduce places.
Scalars interpolation(double t, int n);
/// Of each node (points): its part of the box's volume, whose sum is one.
Scalars volume_shares(const Lattice& lattice);

/// q = A^-1 y along each axis, in place, of numbers at the nodes (points).
void to_control_points(const Lattice& lattice, double* values);
/// The same of places or velocities, and f_y = A^-T f_q: forces on nodes that do the work of forces on control points; (points, 3).
void to_control_points(const Lattice& lattice, const Points& nodes, Points& control_points);
void to_nodes(const Lattice& lattice, Points& forces);

}  // namespace softffd::lobatto
