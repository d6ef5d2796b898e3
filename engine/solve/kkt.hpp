// Accelerations, multipliers and rates from the state: the index-1 form of Eq. (96).
//
//   [ M  D^T  0 ] [ a      ]   [ -f(a=0, lambda=0) ]
//   [ D  0    0 ] [ lambda ] = [ -s(a=0)           ]
//   [ 0  0    K ] [ zdot   ]   [ -g(zdot=0)        ]
//
// D holds the independent constraint rows only; multipliers of redundant rows are zero.
#pragma once

#include <span>
#include <vector>

#include "solve/partition.hpp"
#include "sparse/klu.hpp"
#include "system/blocks.hpp"

namespace bramah {

class Kkt {
 public:
  /// `rows`: independent rows of [c; b]. With a `softness` (one per row, 0 or more) the block of the rows is not 0 but
  /// -softness: accelerations stay bounded where rows become dependent, at singular positions. Solutions are refined
  /// twice, so that of softness / sigma^2 the cube is left, sigma^2 an eigenvalue of D M^-1 D^T.
  Kkt(const System& system, std::span<const Index> rows, std::vector<double> softness = {});

  /// What must be evaluated before factor.
  static Request needed();
  /// Factors with the values of `blocks`. Throws AnalysisError where the matrix is singular.
  void factor(const Blocks& blocks);
  /// Solves for `count` right-hand sides in place, (n + rows + nz) each, column-major.
  void solve(std::span<double> rhs, Index count = 1) const;
  /// The same for sparse::Klu::block right-hand sides, row-major; without softness.
  void solve_block(std::span<double> rhs) const { lu_.solve_block(rhs); }

  /// What `complete` gives next has bits that depend on the state alone.
  void forget_pivots() { lu_.forget_pivots(); }
  /// Sets a, lambda and zdot of `state` from its t, x, v, z and inputs.
  void complete(State& state, Blocks& blocks);

  [[nodiscard]] Index size() const { return size_; }
  [[nodiscard]] const std::vector<Index>& rows() const { return rows_; }
  [[nodiscard]] const SparsePlan& matrix() const { return plan_; }

 private:
  [[nodiscard]] std::string unknown_name(Index i) const;
  [[nodiscard]] std::string unknown_component(Index i) const;
  const System& system_;
  std::vector<Index> rows_;
  Index size_ = 0;
  SparsePlan plan_;
  sparse::Klu lu_;
  Vector rhs_, softness_;
  mutable Vector refinement_;
};

}  // namespace bramah
