// Where the laws of components hold: quantities of the state that have to stay within limits.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "system/analysis_error.hpp"
#include "system/state_functions.hpp"

namespace bramah {

class Limits {
 public:
  /// One bound of a quantity.
  struct Info {
    Index component = 0;
    std::string name, unit, doc;  // "l_2", "m", "length of the piston-side chamber"
    double bound = 0.0;           // SI
    bool lower = true;
    bool ends = true;      // beyond it the law means nothing
    double nominal = 1.0;  // typical magnitude
    std::size_t of = 0;    // which quantity
  };
  explicit Limits(const System& system);

  [[nodiscard]] const std::vector<Info>& info() const { return info_; }
  /// How far the quantities of `state` are inside, in the order of `info`: negative beyond a bound; NaN where a component
  /// cannot tell.
  const Vector& evaluate(const State& state);
  /// "the length of the piston-side chamber, cyl.l_2, is -0.02 m, below 0 m"; `inside` is what evaluate gave.
  [[nodiscard]] std::string text(std::size_t k, double inside) const;
  /// That no analysis begins or goes on at `state` with bound `k` passed, and others that are.
  [[nodiscard]] AnalysisError error(const std::string& analysis, const State& state, std::size_t k);
  /// Bounds that do not end their law and are passed at `state`, beyond rounding: which, and its text.
  [[nodiscard]] std::vector<std::pair<std::size_t, std::string>> passed(const State& state);
  /// Throws the error of the first bound that ends the law and is passed at `state`, beyond rounding.
  void require(const std::string& analysis, const State& state);

 private:
  /// Of the state that was evaluated last.
  [[nodiscard]] bool is_outside(std::size_t k) const;
  const System& system_;
  StateFunctions<bramah_validity> functions_;
  std::vector<Info> info_;
  Vector inside_;
};

/// Limits::require of a new Limits.
void require_within_limits(const System& system, const std::string& analysis, const State& state);

}  // namespace bramah
