#include "contact/implicit/step_matrix.hpp"

#include <Eigen/Dense>

namespace softffd {

namespace {

/// Decrease of the weight of the softening by compressed springs, each time that the matrix has no Cholesky factor.
constexpr double less_softening = 0.25;

}  // namespace

StepMatrix::StepMatrix(const Lattice& lattice) : matrix_(lattice) { x_.setZero(lattice.points(), 3); }

void StepMatrix::linearise(const Points& x, const Scalars& diagonal, double h) {
  linearised_ = {.softening = 1, .per_time = 1 / h};
  x_ = x;
  diagonal_ = diagonal;
}

bool StepMatrix::soften() {
  if (linearised_.softening == 0) return false;
  linearised_.softening -= less_softening;
  return true;
}

LatticeMatrix& StepMatrix::assemble(const Body& body) {
  softffd::assemble(body, x_, linearised_, diagonal_, matrix_);
  return matrix_;
}

void StepMatrix::factor(const StepProblem& problem, bool count) {
  matrix_.factor();
  factorizations_ += count;
  if (!problem.parts.empty()) condense(problem);
}

/// Eliminates all other points. With u = y - Z d for them, y = A^-1 b, Z = A^-1 F, the unknowns d of the parts obey
/// (S - F' Z) d = B' b - F' y.
void StepMatrix::condense(const StepProblem& problem) {
  parts_ = problem.parts;
  at_ = problem.x;
  pinned_ = problem.body.pinned;
  columns_.clear();
  for (int k = 0; k < int(parts_.size()); ++k)
    for (int i = 0; i < parts_[k].unknowns(); ++i) columns_.push_back({k, i, Points::Zero(at_.rows(), 3), {}});
  const int n = int(columns_.size());
  condensed_.setZero(n, n);
  Points unit = Points::Zero(at_.rows(), 3);
  const double per_h2 = 1 / (problem.h * problem.h);
  for (int j = 0; j < n; ++j) {
    Column& column = columns_[j];
    const FreePart& part = parts_[column.part];
    unit.setZero();
    for (const int p : *part.points) set_row(unit, p, part.motion(column.unknown, row(at_, p) - part.centre));
    forces_of(problem, unit, column.forces);
    for (const int p : *part.points)  // the mass of the part contains the inertia of its points
      set_row(column.forces, p, row(column.forces, p) - per_h2 * problem.body.mass[p] * row(unit, p));
    for (int i = 0; i < n; ++i) condensed_(i, j) = along(i, column.forces);
    const int own = column.unknown;
    if (part.unknowns() == 1 || own < 3)
      condensed_(j, j) += per_h2 * part.mass;
    else
      for (int i = 0; i < 3; ++i) condensed_(j - own + 3 + i, j) += per_h2 * part.inertia(i, own - 3);
    for (int p = 0; p < at_.rows(); ++p)
      if (pinned_[p]) set_row(column.forces, p, Vec3::Zero());
    column.moved = column.forces;
    solutions_ += matrix_.solve(column.moved);
  }
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) condensed_(i, j) -= (columns_[i].forces * columns_[j].moved).sum();
  condensed_ = (0.5 * (condensed_ + condensed_.transpose())).eval().inverse().eval();
}

/// Returns the work of forces on the points of a part, per unit of unknown i.
double StepMatrix::along(int i, const Points& forces) const {
  const FreePart& part = parts_[columns_[i].part];
  double sum = 0;
  for (const int p : *part.points) sum += part.motion(columns_[i].unknown, row(at_, p) - part.centre).dot(row(forces, p));
  return sum;
}

void StepMatrix::solve(Points& b, double accuracy) {
  if (columns_.empty()) {
    solutions_ += matrix_.solve(b, accuracy);
    return;
  }
  solve_with_parts(b, std::vector<double>(columns_.size(), 0.0), accuracy);
}

void StepMatrix::solve_together(std::span<Points* const> sides) {
  if (columns_.empty())
    solutions_ += matrix_.solve_together(sides);
  else
    for (Points* side : sides) solve(*side);
}

void StepMatrix::solve_residual(const StepProblem& problem, Points& b) {
  std::vector<double> lack;
  for (const FreePart& part : problem.parts)
    for (int i = 0; i < part.unknowns(); ++i)
      lack.push_back(part.unknowns() == 1 ? part.guide.dot(part.lack.force) : i < 3 ? part.lack.force[i] : part.lack.torque[i - 3]);
  if (lack.empty())
    solve(b);
  else
    solve_with_parts(b, lack, ConjugateGradients::exact);
}

void StepMatrix::solve_with_parts(Points& b, const std::vector<double>& lack, double accuracy) {
  const int n = int(columns_.size());
  Eigen::VectorXd right(n);
  for (int i = 0; i < n; ++i) right[i] = lack[i] + along(i, b);
  for (int p = 0; p < b.rows(); ++p)
    if (pinned_[p]) set_row(b, p, Vec3::Zero());
  solutions_ += matrix_.solve(b, accuracy);
  for (int i = 0; i < n; ++i) right[i] -= (columns_[i].forces * b).sum();
  const Eigen::VectorXd d = condensed_ * right;
  for (int i = 0; i < n; ++i) b -= d[i] * columns_[i].moved;
  for (int i = 0; i < n; ++i) {
    const FreePart& part = parts_[columns_[i].part];
    for (const int p : *part.points) set_row(b, p, row(b, p) + d[i] * part.motion(columns_[i].unknown, row(at_, p) - part.centre));
  }
}

void StepMatrix::forces_of(const StepProblem& problem, const Points& u, Points& f) const {
  f.setZero();
  problem.body.subtract_product(x_, linearised_, u, f);
  for (int axis = 0; axis < 3; ++axis) f.col(axis) = problem.diagonal * u.col(axis) - f.col(axis);
}

}  // namespace softffd
