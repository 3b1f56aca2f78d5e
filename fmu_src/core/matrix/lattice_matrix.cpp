#include "matrix/lattice_matrix.hpp"

namespace softffd {

LatticeMatrix::LatticeMatrix(const Lattice& lattice) {
  if (lattice.lobatto || LayerMatrix::points_per_layer(lattice) <= widest_factor)
    layers_.emplace(lattice);
  else
    gradients_.emplace(lattice);
}

double LatticeMatrix::solve(Points& b, double accuracy) {
  if (!layers_) return double(gradients_->solve(b, accuracy)) / ConjugateGradients::usual;
  layers_->solve(b);
  return 1;
}

}  // namespace softffd
