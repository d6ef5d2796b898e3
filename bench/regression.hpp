// What changed between two results of the bench.
#pragma once

#include <string>
#include <vector>

namespace bramah::bench {

struct Change {
  std::string name;
  double before = 0.0, after = 0.0;  // s
  double noise = 0.0;                // part by which it must change to count
  [[nodiscard]] double ratio() const { return after / before; }
  [[nodiscard]] bool slower() const { return after > before; }
};

struct Regression {
  std::vector<Change> changes;  // beyond noise, the worst first
  std::size_t within_noise = 0;
  std::vector<std::string> only_before, only_after;
  [[nodiscard]] bool slower() const { return !changes.empty() && changes.front().slower(); }
};

/// Two files of Google Benchmark, or two of workloads (.jsonl). A change counts where it exceeds 15 % and three times the
/// variations of both measurements together; single runs vary by 10 %. Throws where a file cannot be read.
Regression changes_between(const std::string& old_file, const std::string& new_file);

}  // namespace bramah::bench
