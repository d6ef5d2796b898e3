// Eigenvalues without the reduction, as others compute them: rungs that the smallest Jacobian is held against.
//
//   A (xdot, a, lambda, zdot) = f                        Eq. (96)
//   F = (xdot, a, zdot) of A^-1 f                        Eq. (97)
//   J = dF/dX by central differences, X = (x, v, z)      Eqs. (98)-(100)
//   E dX/dt = A X, X = (x, v, lambda, z)                 the pencil before any elimination, constraints of positions
#pragma once

#include <Eigen/Dense>
#include <Eigen/SparseCore>
#include <complex>
#include <vector>

#include "linear/descriptor.hpp"
#include "solve/kkt.hpp"
#include "solve/partition.hpp"

namespace bramah {

/// The augmented Jacobian by central differences with one absolute step h (SI) in every variable.
class AugmentedByDifferences {
 public:
  enum class Inverse {
    dense,   // of the whole matrix of Eq. (96) at every point, as in the paper
    sparse,  // the sparse factors, their pattern analysed once; kept where velocities alone are stepped
  };
  AugmentedByDifferences(const System& system, const Partition& partition, Inverse inverse);

  /// Takes the point of Eq. (100). Throws AnalysisError where a component cannot be evaluated.
  void start(const State& reference);
  /// Column j of J, (2n + nz), after start. Throws AnalysisError where the step leaves the domain of a law.
  [[nodiscard]] Eigen::VectorXd column(Index j, double h);
  /// All of J.
  [[nodiscard]] Eigen::MatrixXd jacobian(const State& reference, double h);

  [[nodiscard]] Index states() const { return 2 * system_.n() + system_.nz(); }
  /// What is evaluated at a point, and where the factors hold.
  [[nodiscard]] const Request& request() const { return request_; }
  [[nodiscard]] const Request& rows() const { return inverse_ == Inverse::sparse ? rows_ : request_; }

 private:
  void evaluate(const Request& request);
  // NOLINTNEXTLINE(readability-identifier-naming): the paper's F
  [[nodiscard]] Eigen::VectorXd F(bool factors_hold);

  const System& system_;
  const Partition& partition_;
  Inverse inverse_;
  Blocks blocks_;
  Kkt kkt_;
  SparsePlan mass_;
  Request request_, rows_;
  State state_;
  bool factors_of_reference_ = false;
};

/// The strongest sparse competitor: shift-invert on the exact pencil, unknowns in nominals, multipliers and constraint rows
/// scaled to the forces that they balance. It keeps no false zeros, but 2n + m + l + nz unknowns, and the infinite
/// eigenvalues of its constraints.
class AugmentedPencil {
 public:
  /// Coefficients of the descriptor's last evaluation.
  explicit AugmentedPencil(const Descriptor& descriptor);

  /// Factors shift E - A, shift in 1/s. Throws AnalysisError where it is singular.
  void factor(double shift);
  /// (shift E - A)^-1 E written out: its eigenvalues are 1 / (shift - s), and 0 for infinite s.
  [[nodiscard]] Eigen::MatrixXd written_out() const;
  /// The finite eigenvalues from those of the operator: as many as the machine has, the largest ones.
  [[nodiscard]] std::vector<std::complex<double>> finite(std::vector<std::complex<double>> of_operator) const;
  /// `count` eigenvalues nearest to the shift, conjugates counted, by Arnoldi's method. Throws AnalysisError where it does
  /// not converge.
  [[nodiscard]] std::vector<std::complex<double>> nearest(Index count) const;

  [[nodiscard]] Index size() const { return E_.rows(); }

 private:
  using Sparse = Eigen::SparseMatrix<double, Eigen::ColMajor, Index>;
  Index states_;  // finite eigenvalues
  Sparse E_, A_, shifted_;
  double shift_ = 0.0;
  sparse::Klu lu_;
};

}  // namespace bramah
