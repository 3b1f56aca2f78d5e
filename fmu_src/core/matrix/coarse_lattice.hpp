/// A coarse grid for the same equations, for corrections that block-by-block solutions cannot carry from one end of a body to the other.
///
/// Along each axis some of the points are nodes, including the first and the last; between nodes displacements are linear. With the
/// prolongation P from displacements of the nodes to displacements of all points, the coarse matrix is P^T A P. Nodes are points of the
/// lattice, so that a node couples with its neighbours only, and the coarse matrix is again the matrix of a lattice, with a factor
/// (dissected_matrix.hpp). If the points of a body are evenly spaced, P represents its rigid motions; the coarse grid solves for them,
/// however stiff the body is.
#pragma once
#include <array>
#include <vector>

#include "matrix/dissected_matrix.hpp"
#include "matrix/stencil_matrix.hpp"

namespace softffd {

class CoarseLattice {
 public:
  explicit CoarseLattice(const Lattice& fine);

  /// Computes P^T A P and its factor.
  void factor(const StencilMatrix& matrix);
  /// z += P (P^T A P)^-1 P^T r.
  void add_correction(const Points& r, Points& z);

  const Lattice& lattice() const { return coarse_; }

 private:
  struct Axis {
    std::vector<int> cell;       ///< (fine points of the axis) node at or before each point, never the last node
    std::vector<double> weight;  ///< (fine points of the axis) weight of the node after it [1]
  };
  struct Weight {
    int node, code;  ///< code: the difference between the codes of two neighbours is unique for each of the 27 directions
    double value;
  };
  static Lattice coarsened(const Lattice& fine);
  void weigh_points();
  void add_pair(int p, int q, const Mat3& block);

  Lattice fine_, coarse_;
  std::array<Axis, 3> axes_;
  std::vector<Weight> weights_;  ///< of all points, point after point
  std::vector<int> first_;       ///< (points + 1) index of the first weight of each point
  std::vector<Mat3> products_;   ///< couplings of every node with itself and its 26 neighbours: P^T A P is their sum with the mirror image
  DissectedMatrix matrix_;
  Points nodes_;
  Scalars between_, between_two_;  ///< one coordinate, restricted along z; along z and y
};

}  // namespace softffd
