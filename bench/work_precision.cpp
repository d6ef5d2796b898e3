// Error against work: published problems by every integrator at tolerances 1e-3 ... 1e-10.
//
//   work_precision [FILE]    a Markdown table to standard output, a JSON line per run to FILE
#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "support/benchmarks.hpp"

namespace {

using namespace bramah;
using namespace bramah::testing;
using Integrator = SimulateOptions::Integrator;

constexpr int repetitions = 3;       // the fastest counts
constexpr double long_enough = 0.5;  // s, of a run that is not repeated
constexpr std::array integrators = {Integrator::ida, Integrator::explicit_one_step, Integrator::implicit_one_step};

struct Problem {
  std::string name;
  double until;  // rows of the reference after it are left out
};
const std::vector<Problem> problems = {
    {"pendulum", 100.0}, {"four_bars_2", 10.0}, {"andrews", 0.03}, {"flyball_governor", 10.0}, {"car_axis", 3.0}};

struct Result {
  std::string failure;  // why there is no answer
  double error = 0.0, seconds = 0.0;
  SimulationStatistics statistics;
};

Result measure(const Benchmark& benchmark, const SimulateOptions& options) {
  Result result;
  for (int k = 0; k < repetitions; ++k) {
    try {
      const BenchmarkRun run = run_benchmark(benchmark, options);
      result.seconds = k == 0 ? run.statistics.seconds : std::min(result.seconds, run.statistics.seconds);
      result.error = run.worst().error();
      result.statistics = run.statistics;
      if (result.seconds > long_enough) break;
    } catch (const AnalysisError& error) {
      result.failure = error.what();
      return result;
    }
  }
  return result;
}

std::string written(const char* format, double value) {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

void write_line(std::ostream& out, const Benchmark& benchmark, const SimulateOptions& options, const Result& result) {
  out << "{\"problem\": \"" << benchmark.name << "\", \"integrator\": \"" << integrator_name(options.integrator)
      << "\", ";
  if (options.integrator == Integrator::generalized_alpha) {
    out << "\"step\": " << written("%.3g", options.step);
  } else {
    out << "\"rel_tol\": " << written("%.0e", options.rel_tol);
  }
  if (!result.failure.empty()) {
    out << ", \"reached\": false}\n";
    return;
  }
  const SimulationStatistics& s = result.statistics;
  out << ", \"error\": " << written("%.3g", result.error) << ", \"seconds\": " << written("%.3g", result.seconds)
      << ", \"steps\": " << s.steps << ", \"evaluations\": " << s.evaluations << ", \"jacobians\": " << s.jacobians
      << ", \"factorizations\": " << s.factorizations << "}\n";
}

std::string cell(const Result& result) {
  if (!result.failure.empty()) return "gives up";
  return written("%.0e", result.error) + " in " + written("%.3g", 1e3 * result.seconds) + " ms";
}

Result measure(const Benchmark& benchmark, Integrator integrator, double accuracy, std::ostream& lines) {
  const SimulateOptions options = benchmark_options(benchmark, integrator, accuracy);
  Result result = measure(benchmark, options);
  write_line(lines, benchmark, options, result);
  return result;
}

/// A line for each tolerance, a column for each integrator; then generalized_alpha by numbers of steps.
void write_table(const Benchmark& benchmark, std::ostream& lines) {
  const double end = benchmark.rows.back().t;
  std::printf("\n| %s to %g s |", benchmark.name.c_str(), end);
  for (const Integrator integrator : integrators) std::printf(" %s |", integrator_name(integrator).c_str());
  std::printf("\n| --- |");
  for (std::size_t k = 0; k < integrators.size(); ++k) std::printf(" --- |");
  for (int digits = 3; digits <= 10; ++digits) {
    const std::string tolerance = "1e-" + std::to_string(digits);
    std::printf("\n| %s |", tolerance.c_str());
    for (const Integrator integrator : integrators) {
      std::printf(" %s |", cell(measure(benchmark, integrator, std::stod(tolerance), lines)).c_str());
    }
    std::fflush(stdout);
  }
  std::printf("\n\ngeneralized_alpha:");
  for (const int steps : {1000, 4000, 16000, 64000}) {
    const Result result = measure(benchmark, Integrator::generalized_alpha, end / steps, lines);
    std::printf("%s %d steps %s", steps == 1000 ? "" : ";", steps, cell(result).c_str());
  }
  std::printf(".\n");
  std::fflush(stdout);
}

}  // namespace

int main(int count, char** arguments) {
  std::ofstream lines;
  if (count > 1) {
    lines.open(arguments[1]);
    if (!lines) {
      std::fprintf(stderr, "work_precision: cannot write %s\n", arguments[1]);
      return 2;
    }
  }
  for (const Problem& problem : problems) {
    Benchmark benchmark = load_benchmark(problem.name);
    std::erase_if(benchmark.rows, [&](const ReferenceRow& row) { return row.t > problem.until; });
    write_table(benchmark, lines);
  }
}
