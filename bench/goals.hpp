// Goals of bench/goals.json with the figures of one result beside them.
#pragma once

#include <string>
#include <vector>

#include "results.hpp"

namespace bramah::bench {

struct Goal {
  std::string what;
  double limit = 0.0, measured = 0.0;  // measured NAN: not measured
  bool at_least = false;
  std::string unit;  // "s", "x" for ratios, "1"
  std::string note;  // what decided: a tolerance; why it was missed
  [[nodiscard]] bool met() const { return at_least ? measured >= limit : measured <= limit; }
};

/// Throws std::runtime_error where a goal does not say what it takes.
std::vector<Goal> read_goals(const std::string& file, const Results& results);

/// The line of `workload` with N (and a rung, where it is not empty); null where there is none.
const Value* find_line(const std::vector<Value>& lines, const std::string& workload, double N,
                       const std::string& rung = "");

}  // namespace bramah::bench
