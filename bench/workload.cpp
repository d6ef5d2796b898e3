// One piece of work on one machine of size N, for comparison with other programs and for the page of measurements:
//
//   bramah_workload NAME N [TOLERANCE]
//
// prints one JSON line {"workload", "N", "wall_s", "cpu_s", "error", "steps", "peak_MB", ...}; README.md explains them.
#include <cmath>
#include <cstdio>
#include <functional>
#include <iostream>
#include <optional>
#include <string>

#include "io/json_writer.hpp"
#include "io/read_scene.hpp"
#include "linear/descriptor.hpp"
#include "linear/eigenpairs.hpp"
#include "linear/rungs.hpp"
#include "linear/spectrum.hpp"
#include "solve/equilibrium.hpp"
#include "solve/simulate.hpp"
#include "solve/start.hpp"
#include "stopwatch.hpp"
#include "support/generators.hpp"
#include "support/pendulum.hpp"
#include "system/analysis_error.hpp"

namespace bramah::bench {
namespace {

using support::compiled;

// Above these a work takes many seconds or gigabytes and is left out of the line.
constexpr Index most_dense_states = 2500;
constexpr Index most_states_for_all_eigenvalues = 500;
constexpr int most_links_for_modes = 20000;
constexpr Index most_unknowns_of_rungs = 900;  // dense eigenvalues of the augmented matrices
constexpr double most_inverting = 2e10;  // multiplications in dense inverses; beyond it a few columns stand for all

struct Arguments {
  std::string name;
  int N = 1;
  std::optional<double> tolerance;
};

/// One line of JSON. NaN is null, as "not measured".
class Line {
 public:
  explicit Line(const Arguments& arguments) {
    json_.begin_flat_object().member("workload", arguments.name).member("N", arguments.N);
  }
  template <class T>
  Line& add(std::string_view name, const T& value) {
    json_.member(name, value);
    return *this;
  }
  void print() { std::cout << json_.member("peak_MB", peak_megabytes()).end_object().take(); }

 private:
  JsonWriter json_;
};

/// A machine at its reference state.
struct Machine {
  explicit Machine(const Scene& scene) : model(compiled(scene)) {
    const Options& options = model.options;
    const bool equilibrium = options.linearize.at == LinearizeOptions::At::equilibrium;
    state = reference_state(system(), options, equilibrium, 0.0);
    partition = choose_partition(system(), state, options.linearize.prescribed);
  }
  [[nodiscard]] const System& system() const { return model.system; }
  Compiled model;
  State state;
  Partition partition;
};

void add_times(Line& line, const Elapsed& time, double error, long steps) {
  line.add("wall_s", time.wall).add("cpu_s", time.cpu).add("error", error).add("steps", steps);
}

double largest_error(const std::vector<double>& found, const std::vector<double>& expected) {
  if (found.size() != expected.size()) return NAN;
  double largest = 0.0;
  for (std::size_t k = 0; k < expected.size(); ++k)
    largest = std::max(largest, std::abs(found[k] - expected[k]) / expected[k]);
  return largest;
}

/// Dense and sparse matrices, the ten lowest eigenpairs, and all eigenvalues where they are few; wall_s is that of matrices
/// and ten eigenpairs.
void chain(const Arguments& arguments, const Scene& scene, const std::vector<std::vector<double>>& planes) {
  constexpr int lowest = 10;
  const Machine machine(scene);
  Line line(arguments);
  Descriptor descriptor(machine.system(), machine.partition.rows);
  const Elapsed matrices = median_elapsed([&] { descriptor.evaluate(machine.state); });
  Eigenpairs pairs;
  Elapsed modes{NAN, NAN};
  if (arguments.N <= most_links_for_modes)
    modes = median_elapsed([&] { pairs = find_nearest(descriptor, lowest, 0.0, 0, Proof::skip); });

  std::vector<double> expected, found;
  for (const std::vector<double>& pieces : planes) {
    for (const double frequency : support::lowest_frequencies(pieces, lowest)) expected.push_back(frequency);
  }
  std::sort(expected.begin(), expected.end());
  expected.resize(std::min(expected.size(), static_cast<std::size_t>(lowest)));
  for (const Eigenpair& pair : pairs.pairs) found.push_back(std::abs(pair.eigenvalue.imag()));
  std::sort(found.begin(), found.end());

  double jacobian = NAN, all = NAN, all_error = NAN;
  if (descriptor.states() <= most_dense_states) {
    Linearizer linearizer(machine.system(), machine.partition);
    LinearModel model;
    jacobian = median_elapsed([&] { linearizer.linearize(machine.state, model); }).cpu;
    if (descriptor.states() <= most_states_for_all_eigenvalues) {
      Eigenvalues list;
      all = median_elapsed([&] { list = plain_eigenvalues(model); }).cpu;
      std::vector<double> exact, all_found;
      for (const std::vector<double>& pieces : planes) {
        for (const double f : support::lowest_frequencies(pieces, static_cast<int>(pieces.size())))
          exact.insert(exact.end(), 2, f);
      }
      for (const std::complex<double>& value : list) all_found.push_back(std::abs(value));  // real parts would show
      std::sort(exact.begin(), exact.end());
      std::sort(all_found.begin(), all_found.end());
      all_error = list.size() == exact.size() ? largest_error(all_found, exact) : NAN;
    }
  }
  add_times(line, {matrices.wall + modes.wall, matrices.cpu + modes.cpu}, largest_error(found, expected), pairs.solves);
  line.add("matrices_s", matrices.cpu).add("modes_s", modes.cpu).add("jacobian_s", jacobian);
  line.add("all_eigenvalues_s", all).add("all_eigenvalues_error", all_error);
  line.print();
}

void chain_planar(const Arguments& arguments) {
  chain(arguments, support::planar_chain(arguments.N), {support::planar_pieces(arguments.N)});
}
void chain_spatial(const Arguments& arguments) {
  chain(arguments, support::spatial_chain(arguments.N),
        {support::spatial_pieces_about_y(arguments.N), support::spatial_pieces_about_x(arguments.N)});
}

/// Linearized upright, then simulated for 10 s; the error is that of the upper end of the first upright at the end, in m.
void ladder(const Arguments& arguments, SimulateOptions::Integrator integrator) {
  constexpr double to_time = 10.0;
  const Compiled model = compiled(support::four_bar_ladder(arguments.N));
  const System& system = model.system;
  const State start = consistent_start(system, model.options, 0.0);
  Line line(arguments);

  Linearizer linearizer(system, choose_partition(system, start));
  LinearModel linear;
  const double jacobian = median_elapsed([&] { linearizer.linearize(start, linear); }).cpu;

  SimulateOptions options = model.options.simulate;
  options.from_time = 0.0;
  options.to_time = options.output_step = to_time;
  options.integrator = integrator;
  if (arguments.tolerance) options.rel_tol = *arguments.tolerance;
  Simulation run;
  const Elapsed time = elapsed([&] { run = simulate(system, options, start, {}); });
  const double angle = run.last.x[static_cast<std::size_t>(system.find_x("upright_0.angle"))];
  const double expected = support::ladder_angle(arguments.N, to_time);
  const double error = std::hypot(std::cos(angle) - std::sin(expected), std::sin(angle) - std::cos(expected));
  add_times(line, time, error, run.statistics.steps);
  line.add("evaluations", run.statistics.evaluations).add("tolerance", options.rel_tol).add("jacobian_s", jacobian);
  line.add("integrator", run.statistics.integrator).print();
}
void four_bar_ladder(const Arguments& arguments) { ladder(arguments, SimulateOptions::Integrator::automatic); }
void four_bar_ladder_ida(const Arguments& arguments) { ladder(arguments, SimulateOptions::Integrator::ida); }

using Method = SimulateOptions::Integrator;
constexpr double real_time_step = 1e-3;  // s, of the fixed-step method

/// A step in motion, start-up apart; the mean over up to 100 steps, or over those of two seconds of work. wall_s is that of
/// one step.
void steps(const Arguments& arguments, const Compiled& model, int bodies, Method method) {
  constexpr long first = 10, last = 110;
  constexpr double enough = 2.0;  // s
  const System& system = model.system;
  SimulateOptions options = model.options.simulate;
  options.integrator = method;
  options.step = real_time_step;
  options.output_step = options.to_time = 10.0;
  if (arguments.tolerance) options.rel_tol = *arguments.tolerance;
  Line line(arguments);
  long count = 0;
  double from = NAN, begun = NAN, reached = NAN;
  Observer observer;
  observer.progress = [&](double time, double) {
    if (++count == first) {
      from = time;
      begun = cpu_seconds();
    }
    reached = time;
    return count < last && !(cpu_seconds() - begun > enough);
  };
  const Simulation run = simulate(system, options, consistent_start(system, model.options, 0.0), observer);
  const double spent = cpu_seconds() - begun, step = spent / static_cast<double>(count - first);
  add_times(line, {step, step}, run.statistics.energy.relative(), count);
  line.add("bodies", bodies).add("per_body_s", step / bodies).add("times_real_time", (reached - from) / spent);
  line.print();
}
template <Method method>
void steps_chain(const Arguments& arguments) {
  constexpr double bend = 0.3;  // rad
  steps(arguments, compiled(support::planar_chain(arguments.N, support::bent(bend))), arguments.N, method);
}
/// N four-bars side by side share their uprights: 2 N + 1 bodies.
template <Method method>
void steps_ladder(const Arguments& arguments) {
  steps(arguments, compiled(support::four_bar_ladder(arguments.N)), 2 * arguments.N + 1, method);
}

/// All that a scene asks for by the fixed-step method; the error is the share of the energy that is unaccounted for.
void real_time(const Arguments& arguments, const std::string& file) {
  const Compiled model = compiled(read_scene(BRAMAH_SOURCE_DIR "/scenes/" + file));
  SimulateOptions options = model.options.simulate;
  options.integrator = Method::generalized_alpha;
  options.step = real_time_step;
  options.output_step = options.to_time;
  const State start = reference_state(model.system, model.options, options.from == SimulateOptions::From::equilibrium,
                                      options.from_time);
  Line line(arguments);
  Simulation run;
  const Elapsed time = elapsed([&] { run = simulate(model.system, options, start, {}); });
  add_times(line, time, run.statistics.energy.relative(), run.statistics.steps);
  line.add("times_real_time", (options.to_time - options.from_time) / time.cpu).print();
}

/// A hanging chain, from zero multipliers; the error is that of the weights that its joints carry.
void equilibrium_chain(const Arguments& arguments) {
  const Compiled model = compiled(support::planar_chain(arguments.N));
  Line line(arguments);
  Equilibrium found;
  const Elapsed time = median_elapsed([&] { found = find_equilibrium(model.system, model.options.equilibrium); });
  double error = 0.0;
  for (Index row = 0; row < model.system.m(); ++row) {
    const bool vertical = row % 2 == 1;  // rows x and y of joint 1, 2, ...
    const Index joint = row / 2, below = arguments.N - joint;
    const double weight = vertical ? static_cast<double>(below) * support::rod_mass * support::gravity : 0.0;
    error = std::max(error, std::abs(std::abs(found.state.lambda[static_cast<std::size_t>(row)]) - weight));
  }
  add_times(line, time, error / (arguments.N * support::rod_mass * support::gravity), found.iterations);
  line.print();
}

/// Text of a scene to a compiled system; its libraries are loaded already. There is nothing to be wrong by.
void load_chain(const Arguments& arguments) {
  const std::string text = support::scene_text(support::planar_chain(arguments.N));
  compiled(support::planar_chain(1));
  Line line(arguments);
  Index n = 0;
  const Elapsed time = median_elapsed([&] { n = compiled(read_scene_text(text, "chain.json")).system.n(); });
  add_times(line, time, n == Index{3} * arguments.N ? 0.0 : NAN, 1);
  line.add("bytes", text.size()).print();
}

/// What should cost the same for every body: of a bent chain. wall_s is that of one Newton iteration: rows, partials, the
/// matrix of Eq. (96) filled and factored again, one solution.
void costs(const Arguments& arguments, const Scene& scene) {
  const Compiled model = compiled(scene);
  const System& system = model.system;
  const State state = consistent_start(system, model.options, 0.0);
  const Partition partition = choose_partition(system, state);
  Line line(arguments);
  Blocks blocks(system);
  const Elapsed assembly = median_elapsed([&] { blocks.evaluate(system, state, linearization_partials()); });
  Descriptor descriptor(system, partition.rows);
  const Elapsed linearization = median_elapsed([&] { descriptor.evaluate(state); });
  Kkt kkt(system, partition.rows);
  const Request needed = Kkt::needed().rows("fgs");
  Vector rhs(static_cast<std::size_t>(kkt.size()), 1.0);
  blocks.evaluate(system, state, needed);
  const Elapsed refactor = median_elapsed([&] { kkt.factor(blocks); });
  const Elapsed newton = median_elapsed([&] {
    blocks.evaluate(system, state, needed);
    kkt.factor(blocks);
    std::fill(rhs.begin(), rhs.end(), 1.0);
    kkt.solve(rhs);
  });
  add_times(line, newton, NAN, 1);
  line.add("assembly_s", assembly.cpu).add("descriptor_s", linearization.cpu).add("refactor_s", refactor.cpu);
  line.add("newton_s", newton.cpu).print();
}
void costs_planar(const Arguments& arguments) {
  costs(arguments, support::planar_chain(arguments.N, support::bent(0.3)));
}
void costs_spatial(const Arguments& arguments) {
  costs(arguments, support::spatial_chain(arguments.N, support::Axes::alternating, support::bent(0.3)));
}

/// All rungs of one machine, a line each: error is the worst of all eigenvalues.
void rungs(const Arguments& arguments, const Scene& scene) {
  const Machine machine(scene);
  const System& system = machine.system();
  const Index states = 2 * system.n() + system.nz(),
              unknowns = states + static_cast<Index>(machine.partition.rows.size());
  Linearizer linearizer(system, machine.partition);
  LinearModel model;
  linearizer.linearize(machine.state, model);
  linearizer.estimate_rounding(model);
  Measuring how;
  Eigenvalues nonzero;
  std::size_t zeros = 0;
  how.eigenvalues = unknowns <= most_unknowns_of_rungs;
  if (how.eigenvalues) {
    double logarithms = 0.0;
    for (const Mode& mode : find_spectrum(model).modes) {
      mode.zero ? (void)++zeros : nonzero.push_back(mode.eigenvalue);
      if (!mode.zero) logarithms += std::log(std::abs(mode.eigenvalue));
    }
    how.shift = std::exp(logarithms / static_cast<double>(std::max<std::size_t>(nonzero.size(), 1)));
  }
  const double inverting = 4.0 * static_cast<double>(states) * std::pow(static_cast<double>(unknowns), 3);
  for (const Rung rung : all_rungs) {
    Measuring here = how;
    if (rung == Rung::differences && inverting > most_inverting) here.columns = 1;
    const bool dense = rung != Rung::pencil && rung != Rung::reduced;
    if (dense && states > most_dense_states) continue;
    Line line(arguments);
    line.add("rung", name_of(rung));
    try {
      Contender contender = measure(rung, system, machine.partition, machine.state, here);
      const bool spectrum = !contender.eigenvalues.empty();
      if (spectrum) hold_against(nonzero, zeros, contender);
      const auto if_known = [&](double value) { return spectrum ? value : NAN; };
      const Cost& cost = contender.cost;
      line.add("size", contender.size).add("h", contender.h).add("columns", here.columns);
      line.add("wall_s", cost.total()).add("cpu_s", cost.total()).add("error", if_known(contender.worst_error()));
      line.add("steps", 0).add("assembly_s", cost.assembly).add("reduction_s", cost.reduction);
      line.add("jacobian_s", cost.jacobian()).add("eigenvalues_s", if_known(cost.eigenvalues));
      line.add("total_s", if_known(cost.total()));
      line.add("false_zeros", if_known(static_cast<double>(contender.false_zeros)));
      line.add("largest_false_zero", if_known(contender.largest_false_zero));
      line.add("looks_unstable", contender.looks_unstable).add("taken_MB", cost.peak_MB);
    } catch (const AnalysisError& error) {
      line.add("failure", error.what());
    }
    line.print();
  }
}

const std::vector<std::pair<std::string, std::function<void(const Arguments&)>>>& workloads() {
  static const auto all = [] {
    std::vector<std::pair<std::string, std::function<void(const Arguments&)>>> list = {
        {"chain_planar", chain_planar},
        {"chain_spatial", chain_spatial},
        {"four_bar_ladder", four_bar_ladder},
        {"four_bar_ladder_ida", four_bar_ladder_ida},
        {"equilibrium_chain", equilibrium_chain},
        {"load_chain", load_chain},
        {"costs_planar", costs_planar},
        {"costs_spatial", costs_spatial},
        {"steps_chain_ida", steps_chain<Method::ida>},
        {"steps_chain_explicit", steps_chain<Method::explicit_one_step>},
        {"steps_chain_implicit", steps_chain<Method::implicit_one_step>},
        {"steps_chain_generalized_alpha", steps_chain<Method::generalized_alpha>},
        {"steps_ladder_ida", steps_ladder<Method::ida>},
        {"steps_ladder_explicit", steps_ladder<Method::explicit_one_step>},
        {"steps_ladder_implicit", steps_ladder<Method::implicit_one_step>},
        {"steps_ladder_generalized_alpha", steps_ladder<Method::generalized_alpha>},
        {"real_time_four_bar", [](const Arguments& a) { real_time(a, "four_bar/overdamped.json"); }},
        {"real_time_excavator", [](const Arguments& a) { real_time(a, "crane/dig_cycle.json"); }},
        {"rungs_four_bar", [](const Arguments& a) { rungs(a, support::four_bar_scene()); }}};
    for (const support::Family& family : support::families()) {
      list.emplace_back(std::string("rungs_") + family.name,
                        [make = family.make](const Arguments& a) { rungs(a, make(a.N)); });
    }
    return list;
  }();
  return all;
}

int usage(const std::string& fault) {
  std::cerr << "bramah_workload: " << fault << "\nusage: bramah_workload NAME N [TOLERANCE]\nnames:";
  for (const auto& [name, run] : workloads()) std::cerr << ' ' << name;
  std::cerr << '\n';
  return 2;
}

/// All of `text` as a number.
std::optional<double> number(const std::string& text) {
  std::size_t end = 0;
  try {
    const double value = std::stod(text, &end);
    if (end == text.size()) return value;
  } catch (const std::exception&) {
  }
  return {};
}

int run(const std::vector<std::string>& words) {
  if (words.size() < 2 || words.size() > 3) return usage("expected a name and a size");
  Arguments arguments{words[0], 0, {}};
  const auto found =
      std::find_if(workloads().begin(), workloads().end(), [&](const auto& w) { return w.first == arguments.name; });
  if (found == workloads().end()) return usage("no workload \"" + arguments.name + "\"");
  constexpr double most = 1e6;
  const std::optional<double> size = number(words[1]);
  if (!size || !(*size >= 1.0 && *size <= most) || *size != std::floor(*size))
    return usage("N is \"" + words[1] + "\", expected a whole number from 1 to 1000000");
  arguments.N = static_cast<int>(*size);
  if (words.size() == 3) {
    arguments.tolerance = number(words[2]);
    if (!arguments.tolerance || !(*arguments.tolerance > 0.0))
      return usage("TOLERANCE is \"" + words[2] + "\", expected a number above 0");
  }
  try {
    found->second(arguments);
  } catch (const std::exception& error) {
    Line(arguments).add("failure", error.what()).print();
    return 1;
  }
  return 0;
}

}  // namespace
}  // namespace bramah::bench

int main(int argc, char** argv) { return bramah::bench::run({argv + 1, argv + argc}); }
