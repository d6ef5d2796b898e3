// A matrix by its structure: strongly connected parts in an order that makes it block triangular, zeros and Schur forms of
// each part, and what couples them.
//
// What is exactly zero stays so. Eigenvalues of a part depend on its own entries only, so that a slow part keeps its digits
// beside a fast one, and a triangular matrix its diagonal.
#pragma once

#include <Eigen/Dense>
#include <complex>
#include <vector>

namespace bramah {

struct BlockForm {
  struct Part {
    std::vector<Eigen::Index> states;   // of A, ascending
    Eigen::Index first = 0, count = 0;  // of its nonzero eigenvalues: rows of R
    double norm = 0.0;                  // of the balanced part
    double accepted = 1.0;              // as below
  };
  std::vector<Part> parts;
  Eigen::VectorXd balance;  // (n) powers of two: with each part P, P^-1 A P of these is balanced

  Eigen::MatrixXd right, left;  // (n x n) A right = right triangular, left^T right = 1
  /// left^T A right = [N C; 0 R] (n x n): N has the zeros, block upper triangular by `steps` with zero diagonal blocks; R
  /// is quasi triangular, as of a real Schur form.
  Eigen::MatrixXd triangular;
  std::vector<Eigen::Index> steps;  // dimensions of the null spaces: blocks of size >= 1, >= 2, ...
  std::vector<std::complex<double>>
      nonzero;                           // eigenvalues in the order of R; pairs stand together, positive part first
  std::vector<std::size_t> part_of;      // of each of them
  double accepted = 1.0, refused = 0.0;  // pivots that decided ranks, as in Staircase

  /// Algebraic multiplicity of zero.
  [[nodiscard]] Eigen::Index zeros() const { return triangular.rows() - static_cast<Eigen::Index>(nonzero.size()); }
  /// A basis (n x steps.front()) of the left null space of A.
  [[nodiscard]] Eigen::MatrixXd left_null_space() const;
};

/// `rounding` (n; empty: A is exact): what may remain in an entry of a row where its terms cancel.
BlockForm find_block_form(Eigen::MatrixXd A, const Eigen::VectorXd& rounding = {});

}  // namespace bramah
