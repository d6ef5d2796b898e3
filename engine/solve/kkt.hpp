// Accelerations, multipliers and rates from the state: the index-1 form of Eq. (96).
//
//   [ M  D^T  0 ] [ a      ]   [ -f(a=0, lambda=0) ]
//   [ D  0    0 ] [ lambda ] = [ -s(a=0)           ]
//   [ 0  0    K ] [ zdot   ]   [ -g(zdot=0)        ]
//
// D holds the independent constraint rows only; multipliers of redundant rows are zero.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "solve/partition.hpp"
#include "sparse/klu.hpp"
#include "system/blocks.hpp"

namespace bramah {

class Kkt {
 public:
  /// `rows`: independent rows of [c; b]. With a `softness` (one per row, 0 or more) the block of the rows is not 0 but
  /// -softness: accelerations stay bounded where rows become dependent, at singular positions. `solve` refines what the
  /// softness and rounding leave.
  Kkt(const System& system, std::span<const Index> rows, std::vector<double> softness = {});

  /// What must be evaluated before factor.
  static Request needed();
  /// Factors with the values of `blocks`. Throws AnalysisError where the matrix is singular.
  void factor(const Blocks& blocks);
  /// Solves for `count` right-hand sides in place, (n + rows + nz) each, column-major. Solutions are refined with
  /// residuals of the matrix without softness, in extended precision, until the next correction would be rounding or no
  /// longer shrinks; with a softness that leaves less than 1e-6, only what it leaves is corrected. How often depends on
  /// the matrix and the right-hand side alone.
  void solve(std::span<double> rhs, Index count = 1) const;
  /// The same for sparse::Klu::block right-hand sides, row-major; without softness and not refined.
  void solve_block(std::span<double> rhs) const { lu_.solve_block(rhs); }

  /// What `complete` gives next has bits that depend on the state alone.
  void forget_pivots() { lu_.forget_pivots(); }
  /// Sets a, lambda and zdot of `state` from its t, x, v, z and inputs.
  void complete(State& state, Blocks& blocks);

  [[nodiscard]] Index size() const { return size_; }
  [[nodiscard]] const std::vector<Index>& rows() const { return rows_; }
  [[nodiscard]] const SparsePlan& matrix() const { return plan_; }
  /// By how much the last refinement of the last solution still changed it, relative to the largest acceleration,
  /// multiplier or rate, or to what terms that cancel would give alone; 0 where the next change would be rounding.
  [[nodiscard]] double uncertainty() const { return uncertainty_; }
  /// How many solutions so far were uncertain by more than `few_digits`.
  [[nodiscard]] long imprecise() const { return imprecise_; }
  static constexpr double few_digits = 1e-6;

 private:
  bool remove_softness(std::span<double> solution) const;
  [[nodiscard]] double refine(std::span<double> solution, std::span<const double> rhs) const;
  void find_residual(std::span<const double> solution, std::span<const double> rhs) const;
  [[nodiscard]] std::array<double, 3> sizes_of_terms() const;
  [[nodiscard]] double relative_correction(std::span<const double> solution,
                                           const std::array<double, 3>& least = {}) const;
  [[nodiscard]] std::string unknown_name(Index i) const;
  [[nodiscard]] std::string unknown_component(Index i) const;
  const System& system_;
  std::vector<Index> rows_;
  Index size_ = 0;
  SparsePlan plan_;
  sparse::Klu lu_;
  Vector rhs_, softness_, sizes_;              // sizes_: of unknowns in this machine
  std::vector<Index> diagonal_;                // places of diagonal entries in the plan, -1: none
  mutable Vector given_, correction_, terms_;  // right-hand sides; the residual of one, then its correction; its terms
  mutable std::vector<long double> sum_;
  mutable double uncertainty_ = 0.0;
  mutable long imprecise_ = 0;
};

}  // namespace bramah
