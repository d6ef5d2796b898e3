// One family of equilibria along a number of the scene: each is found from its neighbour, through losses of stability, up to
// where the family ends. At a fold it turns back; the number there is found from the family itself, which is smooth.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "solve/equilibrium.hpp"

namespace bramah {

class Family {
 public:
  /// The equilibrium at a value of the number: from the start values without a guess, else with continue_equilibrium.
  /// Throws where there is none.
  using Solve = std::function<State(double at, const State* guess)>;

  /// Follows the family through `values`, which ascend or descend, from the equilibrium at the first of them that has one;
  /// this one is searched for near `guess`, where given. `system` gives names and nominals.
  void follow(const System& system, const std::vector<double>& values, const Solve& solve,
              const State* guess = nullptr);

  /// A state on the family close to `at`, to begin Newton's method with; null before the family was followed.
  /// Throws AnalysisError beyond its end.
  [[nodiscard]] std::optional<State> guess(double at) const;

  struct Fold {
    double at = 0.0;
    std::string variable;  // that moves most there
    double value = 0.0;    // of this variable, SI
    std::string unit;
  };
  [[nodiscard]] const std::optional<Fold>& fold() const { return fold_; }
  /// Whether the family was not followed to the last value, why, and the last value that it was followed to.
  [[nodiscard]] bool is_lost() const { return !why_.empty(); }
  [[nodiscard]] const std::string& why() const { return why_; }
  [[nodiscard]] double last() const { return points_.back().at; }

 private:
  struct Point {
    double at = 0.0;
    State state;
  };
  bool advance(double to, double shortest, const Solve& solve);
  bool find_fold(const Solve& solve);
  /// Whether a step to this state is one along the family, and not a leap to another.
  [[nodiscard]] bool goes_on(const State& predicted, const State& found) const;
  [[nodiscard]] double distance(const State& a, const State& b) const;
  [[nodiscard]] State predicted(double at) const;

  const System* system_ = nullptr;
  std::vector<Point> points_;  // in the order of the values
  std::optional<Fold> fold_;
  std::string why_;
};

}  // namespace bramah
