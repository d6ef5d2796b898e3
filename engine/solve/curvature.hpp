// Whether the forces of a machine at rest have a potential, and how it curves along the motions that constraints leave.
//
//   H = T^T (f_x + d(D^T lambda)/dx) T,   C_x T = 0 without the coordinates that are held
//
// Forces have a potential where H is symmetric and pressures do not act on coordinates; the rest is a minimum of it where H
// has no negative eigenvalue.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "solve/balance.hpp"

namespace bramah {

class Curvature {
 public:
  Curvature(const System& system, const EquilibriumOptions& options);

  /// At `state` with its multipliers. False where there is nothing to say: no potential, nonholonomic constraints, more than
  /// some hundred motions, or a component that cannot be evaluated.
  bool evaluate(const State& state);
  /// After evaluate: whether H + share * T^T (M + mass) T is positive definite; `mass` (n): added to the diagonal of M.
  [[nodiscard]] bool definite(double share, const Vector& mass) const;
  /// After evaluate: whether no direction falls, but for rounding.
  [[nodiscard]] bool minimum() const;

 private:
  [[nodiscard]] bool coupled_to_pressures() const;
  void take_motions();
  [[nodiscard]] Eigen::MatrixXd lifted() const;

  const System& system_;
  std::vector<Index> free_;  // coordinate -> row, -1 where held
  Index count_ = 0;
  Blocks blocks_;
  SparsePlan stiffness_, mass_, gradients_;
  Eigen::MatrixXd T_, H_, M_;  // (free x motions) in nominals, (motions x motions)
  Eigen::VectorXd size_;       // (motions) of the terms of the diagonal of H
};

}  // namespace bramah
