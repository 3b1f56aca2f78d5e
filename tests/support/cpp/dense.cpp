#include "dense.hpp"

#include <Eigen/Dense>

namespace softffd::dense {

Eigen::VectorXd solve(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  if (a.cols() == 0) return {};
  return a.colPivHouseholderQr().solve(b);
}

Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& a) {
  return a.colPivHouseholderQr().householderQ() * Eigen::MatrixXd::Identity(a.rows(), a.cols());  // a decomposition that is there
}

Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& a) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(a, Eigen::EigenvaluesOnly).eigenvalues();
}

Eigen::MatrixXd eigenvectors(const Eigen::MatrixXd& a) { return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(a).eigenvectors(); }

Eigen::MatrixXd product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) { return a * b; }

}  // namespace softffd::dense
