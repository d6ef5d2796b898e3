// Nothing is judged by a metre, a kilogram, a second or a pascal: every shipped scene in other sizes is the same machine.
//
// Scaled by powers of 16 the data take no rounding, nor do square roots of them: the counts of iterations, steps, events,
// zeros and notes are the same, and results to 1e-12. By powers of 10 they do; results agree to 1e-9 of their condition,
// runs to ten times their tolerance, or to ten times their own error where that is more.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "linear/spectrum.hpp"
#include "solve/simulate.hpp"
#include "support/numbers.hpp"
#include "support/property.hpp"
#include "support/scaled_scene.hpp"
#include "support/scene_parts.hpp"
#include "support/shipped.hpp"
#include "system/analysis_error.hpp"
#include "system/random.hpp"

namespace bramah::testing {
namespace {

/// What came of a machine: numbers with names and units, counts with names.
struct Outcome {
  struct Number {
    std::string name, unit;
    double value = 0.0;
    double size = 0.0;  // what its digits are judged by; 0: itself
  };
  std::vector<Number> numbers;
  std::vector<std::pair<std::string, std::string>> counts;
};

constexpr const char* of_run = "at the end ";

void add_state(const System& system, const State& state, const std::string& of, Outcome& outcome) {
  const double T = system.sizes.time;
  for (std::size_t i = 0; i < system.x.size(); ++i) {
    const Variable& x = system.x[i];
    outcome.numbers.push_back({of + x.name, x.unit, state.x[i], x.size});
    outcome.numbers.push_back({of + x.name + ".rate", x.unit + "/s", state.v[i], x.size / T});
    outcome.numbers.push_back({of + x.name + ".acceleration", x.unit + "/s^2", state.a[i], x.size / (T * T)});
  }
  for (std::size_t i = 0; i < system.z.size(); ++i) {
    const Variable& z = system.z[i];
    outcome.numbers.push_back({of + z.name, z.unit, state.z[i], z.size});
    outcome.numbers.push_back({of + z.name + ".rate", z.unit + "/s", state.zdot[i], z.size / T});
  }
  for (std::size_t i = 0; i < state.lambda.size(); ++i) {
    const Row& row = system.constraint(static_cast<Index>(i));
    const std::string unit = static_cast<Index>(i) < system.m() ? "J/(" : "W/(";
    outcome.numbers.push_back({of + row.name + ".lambda", unit + row.unit + ")", state.lambda[i],
                               system.multiplier_nominal(static_cast<Index>(i))});
  }
}

void add_linear(const Machine& machine, const State& state, Outcome& outcome) {
  const LinearModel model = linear_model(machine, state);
  const Spectrum spectrum = find_spectrum(model);
  for (const NamedQuantity& s : model.states) outcome.counts.emplace_back("state", s.name);
  std::string coordinates;
  for (const NamedQuantity& state_of : model.states) coordinates += state_of.name + " ";
  for (Eigen::Index i = 0; i < model.A.rows(); ++i) {
    for (Eigen::Index j = 0; j < model.A.cols(); ++j) {
      const NamedQuantity &row = model.states[static_cast<std::size_t>(i)],
                          &column = model.states[static_cast<std::size_t>(j)];
      outcome.numbers.push_back({"A(" + row.name + ", " + column.name + ") of " + coordinates,
                                 "(" + row.unit + ")/s/(" + column.unit + ")", model.A(i, j),
                                 row.nominal / (machine.system().scales.time * column.nominal)});
    }
  }
  // Of pairs the upper one, in an order that rounding cannot change.
  std::vector<Mode> modes = spectrum.modes;
  std::stable_sort(modes.begin(), modes.end(), [](const Mode& p, const Mode& q) {
    return std::abs(p.eigenvalue) < (1.0 - 1e-6) * std::abs(q.eigenvalue);
  });
  for (const Mode& mode : modes) {
    const double size = std::abs(mode.eigenvalue);
    outcome.numbers.push_back(
        {"real part, states " + coordinates, "1/s", mode.eigenvalue.real(), size * mode.condition});
    outcome.numbers.push_back(
        {"imaginary part, states " + coordinates, "1/s", std::abs(mode.eigenvalue.imag()), size * mode.condition});
    outcome.counts.emplace_back("mode", std::string(mode.zero ? "zero " : "") + (mode.doubtful ? "doubtful" : ""));
  }
  for (const ZeroBlock& zero : spectrum.zeros) outcome.counts.emplace_back("zero", zero.cause);
  outcome.counts.emplace_back("defective", std::to_string(spectrum.defective.size()));
}

Outcome outcome_of(const Machine& machine) {
  Outcome outcome;
  const System& system = machine.system();
  const Options& options = machine.options();
  const bool equilibrium = options.linearize.at == LinearizeOptions::At::equilibrium;
  try {
    const State state = reference_state(system, options, equilibrium, 0.0);
    add_state(system, state, "", outcome);
    if (equilibrium) {
      const Equilibrium found = find_equilibrium(system, options.equilibrium);
      outcome.counts.emplace_back("iterations", std::to_string(found.iterations));
      outcome.counts.emplace_back("steps of settling", std::to_string(found.steps));
      outcome.counts.emplace_back("moved", std::to_string(found.moved.size()));
      outcome.counts.emplace_back("free directions", std::to_string(found.free_directions.size()));
    }
    for (const StartNote& note : start_notes(system, options, equilibrium, 0.0))
      outcome.counts.emplace_back("note", note.kind);
    if (options.linearize.asked) add_linear(machine, state, outcome);
  } catch (const AnalysisError& error) {
    outcome.counts.emplace_back("refused", error.what());
  }
  const bool settled = options.simulate.from == SimulateOptions::From::equilibrium;
  const State start = reference_state(system, options, settled, options.simulate.from_time);
  const Simulation run = simulate(system, options.simulate, start, {});
  add_state(system, run.last, of_run, outcome);
  const std::string& integrator = run.statistics.integrator;
  outcome.counts.emplace_back("integrator", integrator.substr(0, integrator.find(',')));
  outcome.counts.emplace_back("steps", std::to_string(run.statistics.steps));
  outcome.counts.emplace_back("evaluations", std::to_string(run.statistics.evaluations));
  outcome.counts.emplace_back("restarts", std::to_string(run.statistics.restarts));
  for (const EventTaken& event : run.events) outcome.counts.emplace_back("event", event.name);
  return outcome;
}

/// `at_rest`: tolerance of what is no run. Of runs `of_runs`, or ten times the most that they differ from those of `finer`.
void expect_same(const Outcome& found, const Outcome& expected, const Factors& factors, double at_rest, double of_runs,
                 const Outcome& finer) {
  ASSERT_EQ(found.numbers.size(), expected.numbers.size());
  for (std::size_t i = 0; i < finer.numbers.size(); ++i) {
    const Outcome::Number& e = expected.numbers[i];
    if (e.name.starts_with(of_run))
      of_runs =
          std::max(of_runs, 10.0 * std::abs(e.value - finer.numbers[i].value) / std::max(std::abs(e.value), e.size));
  }
  int faults = 0;
  for (std::size_t i = 0; i < found.numbers.size(); ++i) {
    // Of coordinates that serve equally well rounding may choose others, in which a moving reference has other numbers.
    if (found.numbers[i].name != expected.numbers[i].name) continue;
    const Outcome::Number& e = expected.numbers[i];
    const double tolerance = e.name.starts_with(of_run) ? of_runs : at_rest;
    const auto same = close(found.numbers[i].value / factors.of(e.unit), e.value, tolerance, e.size);
    if (!same && ++faults <= 5) ADD_FAILURE() << e.name << ": " << same.message();
  }
  EXPECT_EQ(faults, 0) << "of " << found.numbers.size();
}

class Scaled : public ::testing::TestWithParam<std::string> {};

TEST_P(Scaled, ByPowersOf16NothingChanges) {
  const Machine as_shipped = load(GetParam());
  const Outcome expected = outcome_of(scaled(as_shipped, {}));
  for (int k = 0; k < support::property_runs(2); ++k) {
    const auto factor = [&](std::uint32_t of) {
      return std::pow(16.0, std::floor(9.0 * random_share(support::property_seed(k), 0, of)) - 4.0);
    };
    const Factors factors{factor(0), factor(1), factor(2)};
    SCOPED_TRACE("length x " + support::exact(factors.length) + ", mass x " + support::exact(factors.mass) +
                 ", time x " + support::exact(factors.time));
    const Outcome found = outcome_of(scaled(as_shipped, factors));
    EXPECT_EQ(found.counts, expected.counts);
    expect_same(found, expected, factors, 1e-12, 1e-12, expected);
  }
}

TEST_P(Scaled, ByPowersOf10ResultsAreTheSame) {
  const Machine as_shipped = load(GetParam());
  Machine base = scaled(as_shipped, {});
  const double of_runs = 10.0 * base.options().simulate.rel_tol;
  const Outcome expected = outcome_of(base);
  base.compiled.options.simulate.rel_tol *= 0.1;
  const Outcome finer = outcome_of(base);  // tells what errors of a step grow to
  for (int k = 0; k < support::property_runs(1); ++k) {
    const auto factor = [&](std::uint32_t of) {
      return std::pow(10.0, std::round(12.0 * random_share(support::property_seed(k), 1, of) - 6.0));
    };
    const Factors factors{factor(0), factor(1), factor(2)};
    SCOPED_TRACE("length x " + support::exact(factors.length) + ", mass x " + support::exact(factors.mass) +
                 ", time x " + support::exact(factors.time));
    expect_same(outcome_of(scaled(as_shipped, factors)), expected, factors, 1e-9, of_runs, finer);
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Scaled, ::testing::ValuesIn(shipped_scenes()), shipped_name);

}  // namespace
}  // namespace bramah::testing
