// Newton's method for a machine at rest: f = 0, g = 0, c = 0 at v = a = zdot = 0, for x, z and lambda without what is held.
//
// The factorization reveals the rank: a direction that no row resists is left where it is, and a load along it is an
// imbalance. All sizes come from the machine: of a row from its terms and its coefficients, of a multiplier from the rows
// that it acts on.
#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "solve/scaled_matrix.hpp"
#include "system/options.hpp"

namespace bramah {

struct FreeDirection {
  std::vector<std::pair<std::string, double>> variables;  // name and share (SI) along the direction
};

/// Which variables are unknowns, and in which column of a matrix; -1 where held.
struct Unknowns {
  std::vector<Index> x, z, lambda;
  Index count = 0;
  Unknowns(const System& system, const EquilibriumOptions& options);

  /// Visits the unknowns as function(column, variable, value); the variable of a multiplier is null.
  template <class Function>
  void each(const System& system, State& state, Function&& function) const {
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (x[i] >= 0) function(x[i], &system.x[i], state.x[i]);
    }
    for (std::size_t i = 0; i < z.size(); ++i) {
      if (z[i] >= 0) function(z[i], &system.z[i], state.z[i]);
    }
    for (std::size_t i = 0; i < lambda.size(); ++i)
      function(lambda[i], static_cast<const Variable*>(nullptr), state.lambda[i]);
  }
};

class Balance {
 public:
  Balance(const System& system, const EquilibriumOptions& options, State& state);

  /// Moves the state to where all rows balance, with steps of at most `largest_step` nominals. False where it does not get
  /// there; the state is then where it gave up.
  bool run(double largest_step = HUGE_VAL);
  [[nodiscard]] int iterations() const { return iterations_; }

  /// Residual and matrix at the state; false where they cannot be evaluated.
  bool evaluate(bool with_matrix);
  void solve();
  /// Largest residual, each row relative to its size.
  [[nodiscard]] double size(Index* where = nullptr) const;
  /// Largest component of the step, in nominals; multipliers do not count.
  [[nodiscard]] double step_size() const;
  void move(double factor);
  /// Whether the state is one of rest: residuals within the tolerance, what a step would still move within rounding, and
  /// no load along a direction that nothing resists. After solve; `row`: the worst one where it is not.
  [[nodiscard]] bool balanced(Index& row) const;

  /// Completes a direction whose parameters, inputs and held variables move: the others follow so that all rows stay zero.
  /// False where they cannot. After evaluate.
  bool follow(Direction& along);

  [[nodiscard]] const std::string& failure() const { return outcome_.message; }
  [[nodiscard]] std::string place_of_failure() const;
  [[nodiscard]] std::string equation_name(Index i) const;
  /// The residual with its unit, where the unit is a plain one.
  [[nodiscard]] std::string equation_residual(Index i) const;
  [[nodiscard]] std::string equation_component(Index i) const;

  /// Whether a column of the multipliers depends on others in the last factored matrix.
  [[nodiscard]] bool multipliers_undetermined() const;
  /// Null vectors of the last factored matrix that move a variable; those of multipliers alone are redundant rows.
  std::vector<FreeDirection> free_directions();

 private:
  class Terms;
  void take_rows(const Blocks& from);
  void take_sizes();
  void take_assembly();
  [[nodiscard]] bool improves(const State& origin, double before, double factor);
  [[nodiscard]] Index unresisted_load() const;

  const System& system_;
  const EquilibriumOptions& options_;
  State& state_;
  Unknowns unknowns_;
  Blocks blocks_;
  ScaledMatrix matrix_;
  // By row: the residual, the sum of the sizes of the terms that components add, what rounding of the unknowns is worth, the
  // same where multipliers have the rounding of the largest, and the size that the residual is held against.
  Vector residual_, terms_, rounding_, noise_, row_size_;
  Vector scale_, step_;   // by unknown: its size, the step in sizes
  Vector nominal_;        // (n)
  bool rounded_ = false;  // rows that repeat each other disagree, by less than the tolerance of the assembly
  Outcome outcome_;
  int iterations_ = 0;
};

}  // namespace bramah
