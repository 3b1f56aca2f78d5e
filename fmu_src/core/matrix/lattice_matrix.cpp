#include "matrix/lattice_matrix.hpp"

#include <algorithm>

namespace softffd {

namespace {

/// Work for right-hand sides that are solved for together, in units of a single solution.
constexpr double work_together = 2;

}  // namespace

LatticeMatrix::LatticeMatrix(const Lattice& lattice) {
  if (has_factor(lattice))
    factor_.emplace(lattice);
  else
    gradients_.emplace(lattice);
}

double LatticeMatrix::solve(Points& b, double accuracy) {
  if (!factor_) return double(gradients_->solve(b, accuracy)) / ConjugateGradients::usual;
  factor_->solve(b);
  return 1;
}

double LatticeMatrix::solve_together(std::span<Points* const> sides) {
  double work = 0;
  if (!factor_)
    for (Points* side : sides) work += solve(*side);
  for (; factor_ && !sides.empty(); work += work_together) {
    const auto now = sides.first(std::min(sides.size(), DissectedMatrix::together));
    factor_->solve_together(now);
    sides = sides.subspan(now.size());
  }
  return work;
}

}  // namespace softffd
