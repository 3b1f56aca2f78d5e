#include "contact/implicit/step_matrix.hpp"

#include "matrix/volume_hessian.hpp"

namespace softffd {

namespace {

/// By how much less of compressed springs' softening is taken each time that the matrix has no Cholesky factor.
constexpr double less_softening = 0.25;

}  // namespace

StepMatrix::StepMatrix(const Lattice& lattice) : hessian_(lattice.points()), matrix_(lattice) { x_.setZero(lattice.points(), 3); }

void StepMatrix::linearise(const StepProblem& problem, double softening) {
  softening_ = softening;
  x_ = problem.x;
  hessian_.compute(problem.body.springs, x_, softening, 1 / problem.h);
}

bool StepMatrix::soften(const StepProblem& problem) {
  if (softening_ == 0) return false;
  linearise(problem, softening_ - less_softening);
  return true;
}

LatticeMatrix& StepMatrix::assemble(const StepProblem& problem) {
  hessian_.fill(problem.body, problem.diagonal, matrix_);
  if (problem.body.volume) add_stiffness(*problem.body.volume, x_, problem.body.pinned, matrix_);
  return matrix_;
}

void StepMatrix::factor() {
  matrix_.factor();
  ++factorizations_;
}

void StepMatrix::forces_of(const StepProblem& problem, const Points& u, Points& f) const {
  f.setZero();
  hessian_.subtract_product(problem.body.springs, u, f);
  if (problem.body.volume) subtract_stiffness_product(*problem.body.volume, x_, u, f);
  for (int axis = 0; axis < 3; ++axis) f.col(axis) = problem.diagonal * u.col(axis) - f.col(axis);
}

}  // namespace softffd
