/// Dense linear algebra for comparison, compiled once: Eigen's decompositions take ten seconds in each program that has them for itself.
#pragma once
#include <Eigen/Core>

namespace softffd::dense {

/// x with the least |a x - b|.
Eigen::VectorXd solve(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
/// An orthonormal basis of a's columns, which are independent.
Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& a);
/// Of a symmetric matrix, the least first.
Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& a);
/// Its eigenvectors, in the same order.
Eigen::MatrixXd eigenvectors(const Eigen::MatrixXd& a);
Eigen::MatrixXd product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

}  // namespace softffd::dense
