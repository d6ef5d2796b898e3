// What each step of the engine costs, for every machine of families.hpp. Names are work/family/bodies; README.md
// explains the counters.
#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <fstream>
#include <functional>
#include <string>

#include "families.hpp"
#include "io/read_scene.hpp"
#include "linear/census.hpp"
#include "linear/descriptor.hpp"
#include "linear/eigenpairs.hpp"
#include "linear/linearize.hpp"
#include "linear/spectrum.hpp"
#include "solve/equilibrium.hpp"
#include "solve/kkt.hpp"
#include "solve/redundancy.hpp"
#include "solve/simulate.hpp"
#include "support/generators.hpp"

namespace bramah::bench {
namespace {

// Above these the work takes minutes or many gigabytes; it is then reported as skipped.
constexpr Index most_states_augmented = 6000;  // dense, (2n + nz)^2 doubles three times over
constexpr Index most_coordinates_differences = 100;
constexpr Index most_states_spectrum = 400;
constexpr double difference_step = 1e-5;  // where Fig. 14 has its minimum

// CPU time of this thread: other work on the machine does not count.
double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}
double seconds_of(const std::function<void()>& work) {
  const double before = cpu_seconds();
  work();
  return cpu_seconds() - before;
}

void describe(benchmark::State& run, const Case& c) {
  const System& system = c.machine().system();
  using benchmark::Counter;
  run.counters["n"] = static_cast<double>(system.n());
  run.counters["m"] = static_cast<double>(system.m());
  run.counters["r"] = static_cast<double>(system.nz());
  run.counters["per_body"] = Counter(c.bodies(), Counter::kIsIterationInvariantRate | Counter::kInvert);
}

/// Measures `work` and reports how much longer it takes than `rival`, both alternately in the same run. The rival,
/// which is the short one, is repeated, so that it does not always meet the memory that the other has left behind.
void compare(benchmark::State& run, const char* ratio, const std::function<void()>& work,
             const std::function<void()>& rival) {
  const double once = seconds_of(rival), other = seconds_of(work);
  const int repetitions = std::clamp(static_cast<int>(0.1 * other / once), 1, 100);
  double ours = 0.0, theirs = 0.0;
  for (auto _ : run) {
    theirs += seconds_of([&] {
                for (int i = 0; i < repetitions; ++i) rival();
              }) /
              repetitions;
    const double seconds = seconds_of(work);
    ours += seconds;
    run.SetIterationTime(seconds);
  }
  run.counters[ratio] = ours / theirs;
}

/// Everything that one linearization asks for.
Request all_rows() { return Request{}.rows("fgcrs"); }
Request all_blocks() {
  return all_rows().blocks({BRAMAH_F_X, BRAMAH_F_V, BRAMAH_F_A, BRAMAH_F_Z, BRAMAH_F_U, BRAMAH_G_X, BRAMAH_G_V,
                            BRAMAH_G_Z, BRAMAH_G_ZDOT, BRAMAH_G_U, BRAMAH_C_X, BRAMAH_R_X, BRAMAH_R_V, BRAMAH_S_X,
                            BRAMAH_S_V, BRAMAH_L_X});
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
    run.SetIterationTime(seconds_of([&] { lu.factor(matrix.view()); }));
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

void linearize_augmented(benchmark::State& run, const Case& c) {
  const Machine& machine = c.machine();
  const Index states = 2 * machine.system().n() + machine.system().nz();
  if (states > most_states_augmented)
    return run.SkipWithError("skipped: the dense unreduced Jacobian takes several gigabytes");
  Linearizer reduced(machine.system(), machine.partition), augmented(machine.system(), machine.partition);
  LinearModel small, large;
  reduced.linearize(machine.state, small);
  augmented.linearize_augmented(machine.state, large);
  compare(
      run, "vs_reduced", [&] { augmented.linearize_augmented(machine.state, large); },
      [&] { reduced.linearize(machine.state, small); });
  describe(run, c);
  run.counters["states"] = static_cast<double>(states);
}

void linearize_differences(benchmark::State& run, const Case& c) {
  const Machine& machine = c.machine();
  if (machine.system().n() > most_coordinates_differences)
    return run.SkipWithError("skipped: dense inverses of this size take minutes");
  Linearizer reduced(machine.system(), machine.partition);
  LinearModel small;
  reduced.linearize(machine.state, small);
  Eigen::MatrixXd J;
  compare(
      run, "vs_reduced",
      [&] { J = augmented_by_differences(machine.system(), machine.partition, machine.state, difference_step); },
      [&] { reduced.linearize(machine.state, small); });
  describe(run, c);
  run.counters["states"] = static_cast<double>(J.rows());
}

/// Eigenvalues of the unreduced Jacobian, against those of the reduced one.
void spectrum_augmented(benchmark::State& run, const Case& c) {
  const Machine& machine = c.machine();
  const Index states = 2 * machine.system().n() + machine.system().nz();
  if (states > most_states_spectrum) return run.SkipWithError("skipped: dense eigenvalues of this size take minutes");
  Linearizer linearizer(machine.system(), machine.partition);
  LinearModel small, large;
  linearizer.linearize(machine.state, small);
  linearizer.linearize_augmented(machine.state, large);
  compare(
      run, "vs_reduced", [&] { benchmark::DoNotOptimize(find_spectrum(large)); },
      [&] { benchmark::DoNotOptimize(find_spectrum(small)); });
  describe(run, c);
  run.counters["states"] = static_cast<double>(states);
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
  run.counters["real_time"] = 1.0 / seconds;
}

void ida_step(benchmark::State& run, const Case& c) { steps(run, c, c.machine().model.options.simulate); }

void alpha_step(benchmark::State& run, const Case& c) {
  SimulateOptions options = c.machine().model.options.simulate;
  options.integrator = SimulateOptions::Integrator::generalized_alpha;
  options.step = 1e-3;
  steps(run, c, options);
}

/// Of the whole process so far: tell it of a work that runs alone.
double peak_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
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
    Work{"assemble_rows", assembly<all_rows>},
    Work{"assemble_blocks", assembly<all_blocks>},
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
    Work{"linearize_augmented", linearize_augmented, Work::Time::own},
    Work{"linearize_differences", linearize_differences, Work::Time::own},
    Work{"spectrum_reduced", spectrum_reduced},
    Work{"spectrum_augmented", spectrum_augmented, Work::Time::own},
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
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
