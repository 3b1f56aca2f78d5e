/// The same equations for fewer points: what block by block solutions cannot carry from one end of a body to the other.
///
/// Along each axis some of the points are nodes, the first and the last among them; between nodes displacements are linear. With P taking
/// displacements of the nodes to those of all points, the coarse matrix is P^T A P. Because nodes are points of the lattice a node meets
/// its neighbours alone, and the coarse matrix is again a matrix of a lattice, with a factor (dissected_matrix.hpp). Rigid motions of a
/// body whose points lie evenly are among what P makes: they are solved for here, however stiff the body is.
#pragma once
#include <array>
#include <vector>

#include "matrix/dissected_matrix.hpp"
#include "matrix/stencil_matrix.hpp"

namespace softffd {

class CoarseLattice {
 public:
  explicit CoarseLattice(const Lattice& fine);

  /// Takes P^T A P and its factor.
  void factor(const StencilMatrix& matrix);
  /// z += P (P^T A P)^-1 P^T r.
  void add_correction(const Points& r, Points& z);

  const Lattice& lattice() const { return coarse_; }

 private:
  struct Axis {
    std::vector<int> cell;      ///< (fine points of the axis) node at or before each, never the last
    std::vector<double> share;  ///< of the node after it
  };
  struct Weight {
    int node, code;  ///< code: differs between two neighbours by a number of its own for each of the 27 directions
    double value;
  };
  static Lattice coarsened(const Lattice& fine);
  void weigh_points();
  void add_pair(int p, int q, const Mat3& block);

  Lattice fine_, coarse_;
  std::array<Axis, 3> axes_;
  std::vector<Weight> weights_;  ///< of all points, one after the other
  std::vector<int> first_;       ///< (points + 1) where a point's begin
  std::vector<Mat3> products_;   ///< of every node with itself and its 26 neighbours: P^T A P is the sum with the mirror image
  DissectedMatrix matrix_;
  Points nodes_;
  Scalars between_, between_two_;  ///< one coordinate, contracted along z; along z and y
};

}  // namespace softffd
