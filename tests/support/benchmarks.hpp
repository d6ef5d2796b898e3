// Published problems with reference values: scenes, tests/reference/benchmarks.json, and what a simulation makes of them.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "solve/simulate.hpp"
#include "support/machine.hpp"

namespace bramah::testing {

struct ReferenceRow {
  double t = 0.0;
  std::vector<std::pair<std::string, double>> values;  // by names of the scene, SI
};

struct Benchmark {
  std::string name;
  Machine machine;
  std::vector<ReferenceRow> rows;  // ascending in t
};

/// By its name in the reference; throws std::runtime_error where there is none.
Benchmark load_benchmark(const std::string& name);

/// A value of a simulation beside its reference.
struct Deviation {
  double t = 0.0;
  std::string name;
  double found = 0.0, expected = 0.0;
  /// Relative to values above 1, absolute below: lengths and angles of all problems are of order 1.
  [[nodiscard]] double error() const;
};

struct BenchmarkRun {
  std::vector<Deviation> deviations;  // all values of all rows
  SimulationStatistics statistics;
  [[nodiscard]] const Deviation& worst() const;
  [[nodiscard]] double error_at_end() const;
};

/// The scene's options, to the last time of the reference, with outputs at its times. `accuracy` is rel_tol, or the step
/// (s) of generalized_alpha.
SimulateOptions benchmark_options(const Benchmark& benchmark, SimulateOptions::Integrator integrator, double accuracy);

/// Simulates from the scene's start. What the integrator throws passes through; std::runtime_error where the run ends
/// before the last row.
BenchmarkRun run_benchmark(const Benchmark& benchmark, const SimulateOptions& options);

/// "ida", "explicit", ...
std::string integrator_name(SimulateOptions::Integrator integrator);

}  // namespace bramah::testing
