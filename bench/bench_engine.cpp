// What each step of the engine costs, for every machine of families.hpp, and one evaluation of every component. Names are
// work/family/bodies and work/type; README.md explains the counters.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include "families.hpp"
#include "io/read_scene.hpp"
#include "linear/census.hpp"
#include "linear/descriptor.hpp"
#include "linear/eigenpairs.hpp"
#include "linear/linearize.hpp"
#include "linear/rungs.hpp"
#include "linear/spectrum.hpp"
#include "solve/equilibrium.hpp"
#include "solve/kkt.hpp"
#include "solve/redundancy.hpp"
#include "solve/simulate.hpp"
#include "solve/start.hpp"
#include "stopwatch.hpp"
#include "support/generators.hpp"

namespace bramah::bench {
namespace {

constexpr Index most_states_spectrum = 400;  // above, the work takes minutes and is reported as skipped

void describe(benchmark::State& run, const Case& c) {
  const System& system = c.machine().system();
  using benchmark::Counter;
  run.counters["n"] = static_cast<double>(system.n());
  run.counters["m"] = static_cast<double>(system.m());
  run.counters["r"] = static_cast<double>(system.nz());
  run.counters["per_body"] = Counter(c.bodies(), Counter::kIsIterationInvariantRate | Counter::kInvert);
}

/// What an integrator asks for in every Newton iteration, and for its matrix.
Request step_rows() { return Request{}.rows("fgcr"); }
Request step_blocks() {
  return Request{}.blocks({BRAMAH_F_X, BRAMAH_L_X, BRAMAH_F_V, BRAMAH_F_A, BRAMAH_F_Z, BRAMAH_F_U, BRAMAH_G_X,
                           BRAMAH_G_V, BRAMAH_G_Z, BRAMAH_G_U, BRAMAH_G_ZDOT, BRAMAH_R_X, BRAMAH_R_V, BRAMAH_C_X});
}

template <Request (*request)()>
void assembly(benchmark::State& run, const Case& c) {
  const Machine& machine = c.machine();
  Blocks blocks(machine.system());
  const Request wanted = request();
  for (auto _ : run) {
    const Outcome outcome = blocks.evaluate(machine.system(), machine.state, wanted);
    if (!outcome.ok()) return run.SkipWithError(outcome.message.c_str());
  }
  describe(run, c);
}

/// The matrix of Eq. (96) with values.
struct KktMatrix {
  explicit KktMatrix(const Machine& machine)
      : blocks(machine.system()), plan(Kkt(machine.system(), machine.partition.rows).matrix()) {
    blocks.evaluate(machine.system(), machine.state, Kkt::needed());
    fill();
  }
  void fill() {
    const double one = 1.0;
    plan.fill(blocks, {&one, 1});
  }
  [[nodiscard]] sparse::CscView view() const {
    return {plan.rows(), plan.columns(), plan.start().data(), plan.row().data(), plan.values().data()};
  }
  Blocks blocks;
  SparsePlan plan;
};

void kkt_fill(benchmark::State& run, const Case& c) {
  KktMatrix matrix(c.machine());
  for (auto _ : run) matrix.fill();
  describe(run, c);
  run.counters["entries"] = static_cast<double>(matrix.plan.nonzeros());
}

void kkt_analyze(benchmark::State& run, const Case& c) {
  const KktMatrix matrix(c.machine());
  sparse::Klu lu;
  for (auto _ : run) lu.analyze(matrix.view());
  describe(run, c);
}

void kkt_factor(benchmark::State& run, const Case& c) {
  const KktMatrix matrix(c.machine());
  for (auto _ : run) {
    sparse::Klu lu;
    lu.analyze(matrix.view());
    run.SetIterationTime(elapsed([&] { lu.factor(matrix.view()); }).cpu);
  }
  describe(run, c);
}

void kkt_refactor(benchmark::State& run, const Case& c) {
  const KktMatrix matrix(c.machine());
  sparse::Klu lu;
  lu.analyze(matrix.view());
  lu.factor(matrix.view());
  for (auto _ : run) lu.factor(matrix.view());
  describe(run, c);
}

void kkt_solve(benchmark::State& run, const Case& c) {
  const KktMatrix matrix(c.machine());
  sparse::Klu lu;
  lu.analyze(matrix.view());
  lu.factor(matrix.view());
  Vector rhs(static_cast<std::size_t>(matrix.plan.rows()), 1.0);
  for (auto _ : run) {
    std::fill(rhs.begin(), rhs.end(), 1.0);
    lu.solve(rhs);
    benchmark::DoNotOptimize(rhs.data());
  }
  describe(run, c);
}

void partition(benchmark::State& run, const Case& c) {
  const Machine& machine = c.machine();
  for (auto _ : run) benchmark::DoNotOptimize(choose_partition(machine.system(), machine.state));
  describe(run, c);
}

/// Rank, coordinates and the texts on redundant rows.
void redundancy(benchmark::State& run, const Case& c) {
  const Machine& machine = c.machine();
  for (auto _ : run) {
    const Partition partition = choose_partition(machine.system(), machine.state);
    benchmark::DoNotOptimize(describe_redundancy(machine.system(), machine.state, partition));
  }
  describe(run, c);
  run.counters["redundant"] = static_cast<double>(machine.partition.redundant.size());
}

void linearizer_setup(benchmark::State& run, const Case& c) {
  const Machine& machine = c.machine();
  for (auto _ : run) Linearizer(machine.system(), machine.partition);
  describe(run, c);
}

/// A linearizer for each of the two rivals, so that neither disturbs the other's memory.
void linearize_reduced(benchmark::State& run, const Case& c) {
  const Machine& machine = c.machine();
  Linearizer linearizer(machine.system(), machine.partition);
  LinearModel model;
  linearizer.linearize(machine.state, model);
  for (auto _ : run) linearizer.linearize(machine.state, model);
  describe(run, c);
  run.counters["states"] = static_cast<double>(model.A.rows());
}

void spectrum_reduced(benchmark::State& run, const Case& c) {
  const Machine& machine = c.machine();
  Linearizer linearizer(machine.system(), machine.partition);
  LinearModel model;
  linearizer.linearize(machine.state, model);
  if (model.A.rows() > most_states_spectrum)
    return run.SkipWithError("skipped: dense eigenvalues of this size take minutes");
  for (auto _ : run) benchmark::DoNotOptimize(find_spectrum(model));
  describe(run, c);
  run.counters["states"] = static_cast<double>(model.A.rows());
}

void equilibrium(benchmark::State& run, const Case& c) {
  const Compiled model = support::compiled(c.at_rest());
  int iterations = 0;
  for (auto _ : run) iterations = find_equilibrium(model.system, model.options.equilibrium).iterations;
  describe(run, c);
  run.counters["newton"] = iterations;
}

/// The mean cost of steps 50 to 250 of a simulation from the general state: start-up does not count.
void steps(benchmark::State& run, const Case& c, SimulateOptions options) {
  constexpr long first = 50, last = 250;
  const Machine& machine = c.machine();
  options.output_step = 1e9;
  options.to_time = 3.0;
  double newton = 0.0, factorizations = 0.0, simulated = 0.0, seconds = 0.0;
  for (auto _ : run) {
    long count = 0;
    double begin = 0.0, end = 0.0, begun = 0.0;
    Observer observer;
    observer.progress = [&](double time, double) {
      ++count;
      if (count == first) {
        begin = cpu_seconds();
        begun = time;
      }
      end = cpu_seconds();
      simulated = time;
      return count < last;
    };
    const Simulation simulation = simulate(machine.system(), options, machine.state, observer);
    if (count <= first) return run.SkipWithError("the simulation ended before step 50");
    run.SetIterationTime((end - begin) / static_cast<double>(count - first));
    seconds = (end - begin) / (simulated - begun);
    const auto all = static_cast<double>(simulation.statistics.steps);
    newton = static_cast<double>(simulation.statistics.newton_iterations) / all;
    factorizations = static_cast<double>(simulation.statistics.factorizations) / all;
  }
  describe(run, c);
  run.counters["newton"] = newton;
  run.counters["factorizations"] = factorizations;
  run.counters["simulated_s"] = simulated;
  run.counters["times_real_time"] = 1.0 / seconds;
}

void ida_step(benchmark::State& run, const Case& c) {
  SimulateOptions options = c.machine().model.options.simulate;
  options.integrator = SimulateOptions::Integrator::ida;
  steps(run, c, options);
}

void alpha_step(benchmark::State& run, const Case& c) {
  SimulateOptions options = c.machine().model.options.simulate;
  options.integrator = SimulateOptions::Integrator::generalized_alpha;
  options.step = 1e-3;
  steps(run, c, options);
}

void descriptor(benchmark::State& run, const Case& c) {
  const Machine& machine = c.machine();
  Descriptor descriptor(machine.system(), machine.partition.rows);
  for (auto _ : run) descriptor.evaluate(machine.state);
  describe(run, c);
  run.counters["peak_MB"] = peak_megabytes();
}

void zeros(benchmark::State& run, const Case& c) {
  const Machine& machine = c.machine();
  Descriptor descriptor(machine.system(), machine.partition.rows);
  descriptor.evaluate(machine.state);
  for (auto _ : run) benchmark::DoNotOptimize(predict_zeros(descriptor));
  describe(run, c);
  run.counters["peak_MB"] = peak_megabytes();
}

void nearest_modes(benchmark::State& run, const Case& c) {
  constexpr Eigen::Index wanted = 20;
  const Machine& machine = c.machine();
  Descriptor descriptor(machine.system(), machine.partition.rows);
  descriptor.evaluate(machine.state);
  const Eigen::Index zeros = predict_zeros(descriptor).count();
  Eigenpairs found;
  for (auto _ : run) found = find_nearest(descriptor, wanted, 0.0, zeros, Proof::skip);
  describe(run, c);
  double residual = 0.0;
  for (const Eigenpair& pair : found.pairs) residual = std::max(residual, pair.residual);
  run.counters["pairs"] = static_cast<double>(found.pairs.size());
  run.counters["residual"] = residual;
  run.counters["peak_MB"] = peak_megabytes();
}

void load_text(benchmark::State& run, const Case& c) {
  const std::string text = c.family() == "four_bar"
                               ? read_source(BRAMAH_SOURCE_DIR "/scenes/four_bar/overdamped.json").text
                               : support::scene_text(c.at_rest());
  for (auto _ : run) benchmark::DoNotOptimize(read_scene_text(text, "scene.json"));
  describe(run, c);
  run.counters["bytes"] = static_cast<double>(text.size());
}

void load_compile(benchmark::State& run, const Case& c) {
  const Scene scene = c.at_rest();
  support::compiled(scene);  // its libraries are loaded now
  for (auto _ : run) benchmark::DoNotOptimize(support::compiled(scene));
  describe(run, c);
}

/// All instances of one type, without the rest of their machine.
struct TypeCase {
  std::string name;
  Compiled model;
  State state;
};

/// One of every shipped component, from the family or scene that has most of them.
std::vector<TypeCase>& types() {
  static std::vector<TypeCase> all;
  return all;
}

void find_types() {
  constexpr int size = 200, side = 14;
  std::vector<Scene> scenes;
  for (const support::Family& family : support::families())
    scenes.push_back(family.make(std::string_view(family.name) == "spring_lattice" ? side : size));
  for (const auto& entry : std::filesystem::recursive_directory_iterator(BRAMAH_SOURCE_DIR "/scenes")) {
    if (entry.path().extension() == ".json") scenes.push_back(read_scene(entry.path().string()));
  }
  std::map<std::string, std::pair<Index, std::size_t>> most;  // instances and scene of every type
  for (std::size_t k = 0; k < scenes.size(); ++k) {
    const Compiled model = support::compiled(scenes[k]);
    for (const Group& group : model.system.groups) {
      auto& [count, scene] = most[group.type->name];
      if (group.count > count) {
        count = group.count;
        scene = k;
      }
    }
  }
  for (const auto& [name, found] : most) {
    Compiled model = support::compiled(scenes[found.second]);
    const State state = consistent_start(model.system, model.options, 0.0);
    std::vector<Group> kept;
    for (Group& group : model.system.groups) {
      if (group.type->name == name) kept.push_back(std::move(group));
    }
    model.system.groups = std::move(kept);
    types().push_back({name, std::move(model), state});
  }
}

/// Values, or all partials, of all instances of one type; per_body is per instance.
void evaluate_type(benchmark::State& run, const TypeCase& type, bool partials) {
  const System& system = type.model.system;
  Blocks blocks(system);
  Request wanted = Request{}.rows("fgcrsy");
  if (partials) wanted.block.fill(true);
  for (auto _ : run) {
    const Outcome outcome = blocks.evaluate(system, type.state, wanted);
    if (!outcome.ok()) return run.SkipWithError(outcome.message.c_str());
  }
  const auto count = static_cast<double>(system.groups.front().count);
  run.counters["instances"] = count;
  run.counters["per_body"] =
      benchmark::Counter(count, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void add_types() {
  find_types();
  for (const TypeCase& type : types()) {
    for (const bool partials : {false, true}) {
      benchmark::RegisterBenchmark(((partials ? "evaluate_partials/" : "evaluate_values/") + type.name).c_str(),
                                   [&type, partials](benchmark::State& state) { evaluate_type(state, type, partials); })
          ->Unit(benchmark::kMicrosecond);
    }
  }
}

struct Work {
  const char* name;
  void (*run)(benchmark::State&, const Case&);
  enum class Time { thread, own, once } time = Time::thread;  // own: set by the work; once: and a single iteration
};

constexpr std::array works = {
    Work{"load_text", load_text},
    Work{"load_compile", load_compile},
    Work{"assemble_step_rows", assembly<step_rows>},
    Work{"assemble_step_blocks", assembly<step_blocks>},
    Work{"assemble_rows", assembly<linearization_rows>},
    Work{"assemble_blocks", assembly<linearization_partials>},
    Work{"kkt_fill", kkt_fill},
    Work{"kkt_analyze", kkt_analyze},
    Work{"kkt_factor", kkt_factor, Work::Time::own},
    Work{"kkt_refactor", kkt_refactor},
    Work{"kkt_solve", kkt_solve},
    Work{"equilibrium", equilibrium},
    Work{"ida_step", ida_step, Work::Time::once},
    Work{"alpha_step", alpha_step, Work::Time::once},
    Work{"partition", partition},
    Work{"redundancy", redundancy},
    Work{"linearizer_setup", linearizer_setup},
    Work{"linearize_reduced", linearize_reduced},
    Work{"spectrum_reduced", spectrum_reduced},
    Work{"descriptor", descriptor},
    Work{"zeros", zeros},
    Work{"nearest_modes", nearest_modes},
};

Case::Extent extent_of(std::string_view work) {
  if (work == "descriptor" || work == "zeros" || work == "nearest_modes") return Case::Extent::modes;
  return work == "partition" || work == "redundancy" ? Case::Extent::partition : Case::Extent::all;
}
/// The partition is measured of all but the machines for modes.
bool is_measured(std::string_view work, const Case& c) {
  const Case::Extent extent = extent_of(work);
  return extent == c.extent() || (extent == Case::Extent::partition && c.extent() == Case::Extent::all);
}

void add_benchmarks() {
  for (const Work& work : works) {
    for (const Case& c : cases()) {
      if (!is_measured(work.name, c)) continue;
      const auto run = [&work, &c](benchmark::State& state) {
        try {
          work.run(state, c);
        } catch (const std::exception& error) {
          state.SkipWithError(error.what());
        }
      };
      benchmark::internal::Benchmark* added =
          benchmark::RegisterBenchmark((std::string(work.name) + "/" + c.name()).c_str(), run);
      added->Unit(benchmark::kMicrosecond);
      if (work.time != Work::Time::thread) added->UseManualTime();
      if (work.time == Work::Time::once) added->Iterations(1);
    }
  }
}

/// The machine, as far as the library does not describe it.
void describe_machine() {
  std::ifstream cpus("/proc/cpuinfo");
  for (std::string line; std::getline(cpus, line);) {
    if (line.rfind("model name", 0) != 0) continue;
    benchmark::AddCustomContext("cpu_model", line.substr(line.find(':') + 2));
    break;
  }
  benchmark::AddCustomContext("compiler", BRAMAH_COMPILER);
  benchmark::AddCustomContext("build_type", BRAMAH_BUILD_TYPE);
}

}  // namespace
}  // namespace bramah::bench

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  bramah::bench::describe_machine();
  bramah::bench::add_benchmarks();
  bramah::bench::add_types();
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
