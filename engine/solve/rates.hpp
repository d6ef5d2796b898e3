// The index-1 form that one-step methods integrate: rates of (x, v, z) by the KKT solve, projection onto the constraints,
// and the exact Jacobian of the rates, never formed but applied and solved with.
//
//   xdot = v     [M D^T; D 0] [vdot; lambda] = [-f; -s]     K zdot = -g        (f, s, g at a = lambda = zdot = 0)
#pragma once

#include <span>
#include <string>
#include <utility>

#include "solve/kkt.hpp"
#include "solve/partition.hpp"
#include "sparse/klu.hpp"
#include "system/blocks.hpp"

namespace bramah {

class Rates {
 public:
  /// The independent rows are those at `start`.
  Rates(const System& system, const State& start);

  /// Sets a, zdot and lambda of `state`. Throws AnalysisError where the KKT matrix is singular or a law is not finite.
  void evaluate(State& state);

  /// Moves x and v of `state` to the nearest point of c = 0 and r = 0 in the metric of the mass matrix: Newton's method
  /// with the matrix of the last `evaluate`, with a fresh one where that is too far away. Throws AnalysisError that names
  /// the row that does not close.
  void project(State& state);

  /// Takes the partials at `state`, completing it as `evaluate` does.
  void linearize(State& state);
  /// out = J in for (x, v, z), both (2n + nz), at the state of the last `linearize`, where `evaluate` was called last.
  void apply(std::span<const double> in, std::span<double> out);
  /// Factors I - gamma J. False where it is singular; `singular` then says at which unknown.
  bool factor(double gamma);
  /// Solves (I - gamma J) y = b in place, b (2n + nz).
  void solve(std::span<double> b);
  [[nodiscard]] const std::string& singular() const { return singular_; }
  /// Kkt::imprecise
  [[nodiscard]] long imprecise() const { return kkt_.imprecise(); }

 private:
  [[nodiscard]] Vector sizes_of_unknowns() const;
  [[nodiscard]] double violation(const State& state, Index& row);
  bool close(State& state, Index& row);

  const System& system_;
  Partition partition_;
  Blocks blocks_, linear_;  // linear_: at the state of the last linearization
  Kkt kkt_;
  Index n_, nz_, rows_;
  SparsePlan partials_, leading_, newton_;  // of (f, s, g) by (x, v, z), by (a, zdot); of the Newton matrix
  sparse::Klu lu_;
  double gamma_ = 0.0;
  Vector rhs_, product_;
  std::pair<Vector, Vector> before_;  // x, v before the projection
  std::string singular_;
};

}  // namespace bramah
