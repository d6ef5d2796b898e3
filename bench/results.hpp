// Results of the bench, read back: lines of bramah_workload, and the file of Google Benchmark.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "system/scene.hpp"

namespace bramah::bench {

/// Text of a file; throws std::runtime_error that says what to do.
std::string contents(const std::string& file);
/// One JSON document; std::runtime_error names place and fault.
Value read_json(const std::string& file);
/// One JSON document a line.
std::vector<Value> read_json_lines(const std::string& file);

/// Member `key` as a number; NAN where it is missing or null.
double number(const Value& object, std::string_view key);
/// Member `key` as a text; "" where it is missing.
std::string text(const Value& object, std::string_view key);

/// bench/results/NAME.*: what one run of run_bench.sh leaves.
struct Results {
  explicit Results(const std::string& stem);
  std::vector<Value> lines;  // NAME.workloads.jsonl
  Value micro;               // NAME.json: {"context", "benchmarks"}
  Value comparison;          // NAME.compare.json: `bramah compare` of the four-bar
  [[nodiscard]] std::string context(std::string_view key) const;
};

/// One work of the micro-benchmarks: median in s, and its coefficient of variation.
struct Micro {
  std::string name;
  double seconds = 0.0, variation = 0.0, per_body = 0.0;  // per_body NAN: none
};
std::vector<Micro> micro_benchmarks(const Value& file);

}  // namespace bramah::bench
