// Eigenvalues that rounding cannot tell apart, taken together: their invariant subspace is well conditioned where the
// vectors of each are parallel.
#pragma once

#include <Eigen/Dense>
#include <complex>
#include <optional>

#include "linear/spectrum.hpp"

namespace bramah {

class InvariantSubspaces {
 public:
  /// `triangular` (n x n) is block upper triangular, its first `zeros` rows and columns with a zero diagonal, the rest
  /// nonsingular. `perturbation`: norm of what rounding may have added to it.
  InvariantSubspaces(const Eigen::MatrixXd& triangular, Eigen::Index zeros, double perturbation);

  /// The smallest group around the nonzero eigenvalue `near` that rounding keeps apart from all others and from zero;
  /// none where there is no such group, or where it has as many vectors as members.
  std::optional<DefectiveGroup> defective_group(std::complex<double> near);

 private:
  void bring_forward(Eigen::Index from, Eigen::Index to);
  [[nodiscard]] DefectiveGroup leading(Eigen::Index size) const;

  Eigen::MatrixXcd zero_, coupling_;  // the first diagonal block; the block beside it, in the vectors of schur_
  Eigen::MatrixXcd schur_, vectors_;  // of the rest
  double perturbation_;
};

}  // namespace bramah
