// The eigenvalue 0 of a matrix, taken out by rank decisions: null space, null space of what is left, and so on
// (Kublanovskaya 1966). The dimensions tell the Jordan blocks, and the rest keeps its eigenvalues free of their scatter.
#pragma once

#include <Eigen/Dense>
#include <vector>

namespace bramah {

/// How many times its rounding an entry must have to be taken for nonzero: terms that cancel already inside an entry, and
/// signs that conspire more than those that were tried.
inline constexpr double rounding_margin = 100.0;

struct Staircase {
  Eigen::MatrixXd Q;                // (n x n) orthogonal; Q^T A Q is block upper triangular, zeros first
  Eigen::MatrixXd triangular;       // Q^T A Q
  std::vector<Eigen::Index> steps;  // dimensions of the null spaces: blocks of size >= 1, >= 2, ...
  double accepted = 1.0;            // smallest pivot taken for nonzero, relative to the largest of its step
  double refused = 0.0;             // largest taken for zero

  /// Algebraic multiplicity of zero.
  [[nodiscard]] Eigen::Index zeros() const;
  /// Sizes of the Jordan blocks of zero, largest first.
  [[nodiscard]] std::vector<int> block_sizes() const;
};

/// A with zeros where a row is not above a small multiple of its `rounding` (n).
Eigen::MatrixXd without_rounding(Eigen::MatrixXd A, const Eigen::VectorXd& rounding);

/// `A` should be scaled so that its rows and columns are comparable. A pivot counts as zero below
/// `tolerance` times the norm of its row, a row where it is not above a small
/// multiple of its `rounding` (n; empty: A is exact).
Staircase find_staircase(const Eigen::MatrixXd& A, const Eigen::VectorXd& rounding = {}, double tolerance = 1e-11);
/// The same of a matrix that is known to have no other eigenvalue: every step finds a null space.
Staircase find_staircase_of_nilpotent(const Eigen::MatrixXd& N, double tolerance = 1e-11);

}  // namespace bramah
