#include "contact/implicit/step_matrix.hpp"

namespace softffd {

namespace {

/// By how much less of compressed springs' softening is taken each time that the matrix has no Cholesky factor.
constexpr double less_softening = 0.25;

}  // namespace

StepMatrix::StepMatrix(const Lattice& lattice) : matrix_(lattice) { x_.setZero(lattice.points(), 3); }

void StepMatrix::linearise(const StepProblem& problem) {
  linearised_ = {.softening = 1, .per_time = 1 / problem.h};
  x_ = problem.x;
}

bool StepMatrix::soften() {
  if (linearised_.softening == 0) return false;
  linearised_.softening -= less_softening;
  return true;
}

LatticeMatrix& StepMatrix::assemble(const StepProblem& problem) {
  softffd::assemble(problem.body, x_, linearised_, problem.diagonal, matrix_);
  return matrix_;
}

void StepMatrix::factor() {
  matrix_.factor();
  ++factorizations_;
}

void StepMatrix::forces_of(const StepProblem& problem, const Points& u, Points& f) const {
  f.setZero();
  problem.body.subtract_product(x_, linearised_, u, f);
  for (int axis = 0; axis < 3; ++axis) f.col(axis) = problem.diagonal * u.col(axis) - f.col(axis);
}

}  // namespace softffd
