// What the dense eigenvalues take from LAPACK.
#pragma once

#include <Eigen/Dense>
#include <complex>
#include <vector>

namespace bramah::lapack {

/// Scales A (n x n) to D^-1 A D with comparable norms of rows and columns; the diagonal of D: powers of two, about 1 in
/// their geometric mean.
Eigen::VectorXd balance(Eigen::MatrixXd& A);

/// A (n x n) becomes its real Schur form Z^T A Z; its eigenvalues in their order, pairs positive part first. AnalysisError
/// where the QR iteration does not converge.
void schur(Eigen::MatrixXd& A, Eigen::MatrixXd& Z, std::vector<std::complex<double>>& eigenvalues);

/// Right and left eigenvectors of a real Schur form T (n x n) for its last `count` eigenvalues, packed: of a pair, real
/// and imaginary part of the first one in two columns.
void vectors(const Eigen::MatrixXd& T, Eigen::Index count, Eigen::MatrixXd& right, Eigen::MatrixXd& left);

/// Eigenvalues of A, balanced and permuted, in the order in which the QR iteration finds them.
std::vector<std::complex<double>> eigenvalues(Eigen::MatrixXd A);

}  // namespace bramah::lapack
