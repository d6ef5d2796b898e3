#include "support/benchmarks.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "solve/start.hpp"
#include "support/generators.hpp"
#include "support/reference.hpp"

namespace bramah::testing {
namespace {

Machine machine_of(const std::string& name) {
  const std::string ladder = "four_bars_";
  if (name.rfind(ladder, 0) == 0 && name != "four_bars_2") {
    Scene scene = support::four_bar_ladder(std::stoi(name.substr(ladder.size())));
    Compiled compiled = compile(scene, registry());
    return {std::move(scene), std::move(compiled)};
  }
  if (name == "bricard") return load("scenes/redundant/bricard.json");
  return load("scenes/benchmarks/" + (name == "four_bars_2" ? "four_bars" : name) + ".json");
}

const Deviation& largest(const std::vector<Deviation>& list) {
  return *std::max_element(list.begin(), list.end(),
                           [](const Deviation& a, const Deviation& b) { return a.error() < b.error(); });
}

}  // namespace

Benchmark load_benchmark(const std::string& name) {
  const nlohmann::json problems = reference("benchmarks.json")["problems"];
  if (!problems.contains(name)) throw std::runtime_error("no reference values of " + name);
  Benchmark benchmark{name, machine_of(name), {}};
  for (const auto& row : problems[name]["rows"]) {
    ReferenceRow values{number(row["t"]), {}};
    for (const auto& [key, value] : row.items()) {
      if (key != "t") values.values.emplace_back(key, number(value));
    }
    benchmark.rows.push_back(std::move(values));
  }
  return benchmark;
}

double Deviation::error() const {
  const double difference = std::abs(found - expected) / std::max(1.0, std::abs(expected));
  return std::isfinite(difference) ? difference : HUGE_VAL;
}

const Deviation& BenchmarkRun::worst() const { return largest(deviations); }
double BenchmarkRun::error_at_end() const {
  double error = 0.0;
  for (const Deviation& d : deviations) {
    if (d.t == deviations.back().t) error = std::max(error, d.error());
  }
  return error;
}

SimulateOptions benchmark_options(const Benchmark& benchmark, SimulateOptions::Integrator integrator, double accuracy) {
  SimulateOptions options = benchmark.machine.options().simulate;
  options.integrator = integrator;
  (integrator == SimulateOptions::Integrator::generalized_alpha ? options.step : options.rel_tol) = accuracy;
  options.output_step = 0.0;
  options.output_times.clear();
  for (const ReferenceRow& row : benchmark.rows) options.output_times.push_back(row.t);
  options.to_time = benchmark.rows.back().t;
  return options;
}

BenchmarkRun run_benchmark(const Benchmark& benchmark, const SimulateOptions& options) {
  const Machine& machine = benchmark.machine;
  BenchmarkRun run;
  auto row = benchmark.rows.begin();
  Observer observer;
  observer.output = [&](const State& state) {
    if (row == benchmark.rows.end() || std::abs(state.t - row->t) > 1e-12 * row->t) return;
    for (const auto& [name, expected] : row->values) {
      run.deviations.push_back({row->t, name, machine.value(state, name), expected});
    }
    ++row;
  };
  const State start = consistent_start(machine.system(), machine.options(), options.from_time);
  run.statistics = simulate(machine.system(), options, start, observer).statistics;
  if (row != benchmark.rows.end()) throw std::runtime_error(benchmark.name + " has not reached all times");
  return run;
}

std::string integrator_name(SimulateOptions::Integrator integrator) {
  using Kind = SimulateOptions::Integrator;
  switch (integrator) {
    case Kind::automatic: return "auto";
    case Kind::ida: return "ida";
    case Kind::explicit_one_step: return "explicit";
    case Kind::implicit_one_step: return "implicit";
    case Kind::generalized_alpha: return "generalized_alpha";
  }
  return "";
}

}  // namespace bramah::testing
